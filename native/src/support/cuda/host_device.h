#pragma once
// Attributes of functions that run on a CUDA device as well as on the processor.

#ifdef __CUDACC__
#define SADDLEBACK_HOST_DEVICE __host__ __device__
#define SADDLEBACK_RARE __noinline__ __host__ __device__  // a function of its own on a device
#else
#define SADDLEBACK_HOST_DEVICE
#define SADDLEBACK_RARE
#endif
