# SPDX-License-Identifier: MIT
# Compiles for Linux on 64-bit Arm on a Debian, with its g++-aarch64-linux-gnu. Besides the Python that runs here, name
# Python_INCLUDE_DIR and PYTHON_MODULE_EXTENSION: tests/platforms.sh does.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_CXX_FLAGS_INIT -Wno-psabi)  # nobody links this with objects of GCC 9
