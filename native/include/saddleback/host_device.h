#pragma once
// What functions need to be called that a CUDA device runs as well as the processor.

#ifdef __CUDACC__
#define SADDLEBACK_HOST_DEVICE __host__ __device__
#else
#define SADDLEBACK_HOST_DEVICE
#endif
