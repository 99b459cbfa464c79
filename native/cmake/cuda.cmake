# SPDX-License-Identifier: MIT
# The optional CUDA part: a library and a Python module of their own, so that the rest neither needs them nor links to
# them. cudart is linked statically: the module loads on a machine without a driver and says so when asked.
set(SADDLEBACK_CUDA_OLDEST 75)
if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
  # Machine code for each; the last also as PTX, from which the driver makes code for whatever comes later.
  set(CMAKE_CUDA_ARCHITECTURES 75-real 80-real 86-real 89-real 90 CACHE STRING "CUDA architectures")
endif()
enable_language(CUDA)
if(NOT CMAKE_CUDA20_STANDARD_COMPILE_OPTION)  # CMake 3.25 does not know that nvcc understands it
  set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION -std=c++20)
  set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION -std=c++20)
endif()
set(CMAKE_CUDA_STANDARD 20)
set(CMAKE_CUDA_STANDARD_REQUIRED ON)
set(CMAKE_CUDA_RUNTIME_LIBRARY Static)

add_library(saddleback_cuda STATIC
  src/geodesics/cuda/device_arcs.cu
  src/geodesics/cuda/device_search.cu
  src/support/cuda/cuda_devices.cu
  src/support/cuda/host_pinning.cu
  src/voronoi2d/cuda/device_signs.cu
  src/voronoi2d/cuda/device_voronoi.cu
)
# To the bit what the processor computes: multiplications and additions stay apart there as well.
set_source_files_properties(src/geodesics/cuda/device_arcs.cu src/geodesics/cuda/device_search.cu src/voronoi2d/cuda/device_signs.cu
  src/voronoi2d/cuda/device_voronoi.cu
  PROPERTIES COMPILE_OPTIONS "-fmad=false;-diag-suppress;177")  # 177: names used in braces count as unused
target_include_directories(saddleback_cuda PUBLIC include PRIVATE src)
target_compile_definitions(saddleback_cuda PRIVATE SADDLEBACK_CUDA_OLDEST=${SADDLEBACK_CUDA_OLDEST})
target_compile_options(saddleback_cuda PRIVATE
  -Xcompiler=-Wall,-Wextra,-Wshadow
  $<$<BOOL:${SADDLEBACK_WARNINGS_AS_ERRORS}>:-Werror=all-warnings>)
set_target_properties(saddleback_cuda PROPERTIES CUDA_VISIBILITY_PRESET hidden)
