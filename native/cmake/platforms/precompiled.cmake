# SPDX-License-Identifier: MIT
# Given as CMAKE_PROJECT_INCLUDE where nothing is optimized: reading Eigen and pybind11 takes the compiler most of its time
# then, so it reads them once.
function(precompile_headers)
  target_precompile_headers(saddleback PRIVATE <Eigen/Core>)
  target_precompile_headers(_saddleback PRIVATE <Eigen/Core> <pybind11/numpy.h>)
  get_target_property(_sources saddleback SOURCES)
  foreach(_source IN LISTS _sources)  # what is compiled with options of its own cannot use them
    get_source_file_property(_options ${_source} TARGET_DIRECTORY saddleback COMPILE_OPTIONS)
    if(_options)
      set_source_files_properties(${_source} TARGET_DIRECTORY saddleback PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
    endif()
  endforeach()
endfunction()
cmake_language(DEFER DIRECTORY ${CMAKE_SOURCE_DIR} CALL precompile_headers)
