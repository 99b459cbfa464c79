# SPDX-License-Identifier: MIT
# The compiler reads the headers of others once, instead of once for each of our sources: a third of the build otherwise.
# Every source still names what it uses: clang-tidy, and builds by ccache, which cannot keep them, read without.
# CMAKE_DISABLE_PRECOMPILE_HEADERS turns them off.
set(_of_all <algorithm> <array> <atomic> <cmath> <functional> <map> <memory> <mutex> <numeric> <optional> <span> <string>
  <thread> <unordered_map> <vector> <Eigen/Core> <Eigen/Geometry>)

# precompile_headers(TARGET HEADER...): for its sources but those that are compiled with options of their own.
function(precompile_headers target)
  target_precompile_headers(${target} PRIVATE ${ARGN})
  get_target_property(_sources ${target} SOURCES)
  get_target_property(_folder ${target} SOURCE_DIR)
  foreach(_source IN LISTS _sources)
    cmake_path(ABSOLUTE_PATH _source BASE_DIRECTORY ${_folder})
    get_source_file_property(_options ${_source} TARGET_DIRECTORY ${target} COMPILE_OPTIONS)
    if(_options)
      set_source_files_properties(${_source} TARGET_DIRECTORY ${target} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
    endif()
  endforeach()
endfunction()

if(NOT SADDLEBACK_LIBRARY)
  precompile_headers(saddleback ${_of_all})
endif()
if(SADDLEBACK_PYTHON)
  precompile_headers(_saddleback ${_of_all} <pybind11/numpy.h> <pybind11/stl.h>)
endif()
