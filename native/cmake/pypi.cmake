# SPDX-License-Identifier: MIT
# fetch_from_pypi(REQUIREMENT ARCHIVE SHA256 FOLDER PIP_OPTION...): unpacks a package of PyPI into ${SADDLEBACK_DEPS},
# unless FOLDER is there.
#
# Sources come from PyPI because whoever builds a Python package reaches it: pip is a requirement of the build.
set(SADDLEBACK_DEPS ${CMAKE_BINARY_DIR}/_deps)

function(fetch_from_pypi requirement archive sha256 folder)
  if(EXISTS ${SADDLEBACK_DEPS}/${folder})
    return()
  endif()
  message(STATUS "Fetching ${requirement} with pip")
  find_package(Python 3.10 REQUIRED COMPONENTS Interpreter)
  set(_archive ${SADDLEBACK_DEPS}/${archive})
  execute_process(
    COMMAND ${Python_EXECUTABLE} -m pip download --quiet --no-deps --dest ${SADDLEBACK_DEPS} ${ARGN} ${requirement}
    COMMAND_ERROR_IS_FATAL ANY)
  file(SHA256 ${_archive} _found)
  if(NOT _found STREQUAL sha256)
    message(FATAL_ERROR "${_archive} is not the file that was reviewed: its SHA-256 is ${_found} instead of ${sha256}.")
  endif()
  file(ARCHIVE_EXTRACT INPUT ${_archive} DESTINATION ${SADDLEBACK_DEPS})
endfunction()
