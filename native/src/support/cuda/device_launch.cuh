#pragma once
// Kernels with a thread for each of some things.

#include <algorithm>
#include <cstdint>

#include "support/cuda/cuda_check.h"

namespace saddleback {
namespace {

constexpr int k_threads = 256;
/// Returns at least one, which finds nothing to do where there is nothing.
inline unsigned blocks_for(std::int64_t count) {
  return static_cast<unsigned>(std::max<std::int64_t>(1, (count + k_threads - 1) / k_threads));
}

/// Brings kernels to the device. When one is first called while others run, the caller may have to wait for their end,
/// and nobody can stop it meanwhile.
template <class... Kernels>
void load_kernels(Kernels*... kernels) {
  cudaFuncAttributes attributes{};
  (check_cuda(cudaFuncGetAttributes(&attributes, reinterpret_cast<const void*>(kernels)), "loading kernels"), ...);
}

__device__ inline std::int32_t thread_number() {
  return static_cast<std::int32_t>(blockIdx.x * blockDim.x + threadIdx.x);
}

}  // namespace
}  // namespace saddleback
