#pragma once
// Failed CUDA calls as exceptions. Only for sources of the CUDA module: they never cross its border, see cuda_module.h.

#include <cuda_runtime.h>
#include <stdexcept>
#include <string>

namespace saddleback {

/// Holds what the driver says, and during what.
class CudaFailure : public std::runtime_error {
 public:
  CudaFailure(const char* doing, cudaError_t error)
      : std::runtime_error(std::string(doing) + ": " + cudaGetErrorString(error)) {}
};

inline void check_cuda(cudaError_t error, const char* doing) {
  if (error == cudaSuccess) return;
  (void)cudaGetLastError();  // or the next check takes it for its own
  throw CudaFailure(doing, error);
}

}  // namespace saddleback
