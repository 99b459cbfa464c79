# SPDX-License-Identifier: MIT
# Compiles for 64-bit Windows on a Debian, with its g++-mingw-w64-x86-64-posix. Besides the Python that runs here, name
# Python_INCLUDE_DIR, Python_LIBRARY (python3XX.dll itself) and PYTHON_MODULE_EXTENSION: tests/platforms.sh does.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR AMD64)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_MODULE_LINKER_FLAGS_INIT "-static -s")  # the compiler's own libraries go into the module
