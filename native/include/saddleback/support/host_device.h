#pragma once
// What functions need to be called that a CUDA device runs as well as the processor.

#ifdef __CUDACC__
#define SADDLEBACK_HOST_DEVICE __host__ __device__
#define SADDLEBACK_RARE __noinline__ __host__ __device__  // a function of its own on a device
#else
#define SADDLEBACK_HOST_DEVICE
#define SADDLEBACK_RARE
#endif
