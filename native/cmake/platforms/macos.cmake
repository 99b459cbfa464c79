# SPDX-License-Identifier: MIT
# Compiles and links for macOS with the clang of PyPI's ziglang, to see that it does; what it makes runs nowhere here.
# SADDLEBACK_ZIG is the folder of the commands that tests/platforms.sh makes: .../aarch64 or .../x86_64.
set(CMAKE_SYSTEM_NAME Darwin)
get_filename_component(CMAKE_SYSTEM_PROCESSOR ${SADDLEBACK_ZIG} NAME)
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES SADDLEBACK_ZIG)
set(CMAKE_CXX_COMPILER ${SADDLEBACK_ZIG}/clang++)
set(CMAKE_AR ${SADDLEBACK_ZIG}/ar CACHE FILEPATH "")
set(CMAKE_RANLIB ${SADDLEBACK_ZIG}/ranlib CACHE FILEPATH "")
set(CMAKE_STRIP true CACHE FILEPATH "")
set(CMAKE_INSTALL_NAME_TOOL true CACHE FILEPATH "")
set(CMAKE_OSX_SYSROOT "" CACHE PATH "")
