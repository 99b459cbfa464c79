#pragma once
// Reductions over the lanes of a warp: one instruction from compute capability 8.0 on.

namespace saddleback {

constexpr unsigned k_warp = 0xffffffffu;

/// A number that all lanes have, said so that the compiler knows it too: loops up to it need not gather lanes again.
__device__ inline int uniform(int value) { return __shfl_sync(k_warp, value, 0); }

/// The least of all lanes' numbers.
__device__ inline unsigned warp_min(unsigned value) {
#if __CUDA_ARCH__ >= 800
  return __reduce_min_sync(k_warp, value);
#else
  for (int step = 16; step > 0; step /= 2) value = min(value, __shfl_xor_sync(k_warp, value, step));
  return value;
#endif
}

/// The largest.
__device__ inline int warp_max(int value) {
#if __CUDA_ARCH__ >= 800
  return __reduce_max_sync(k_warp, value);
#else
  for (int step = 16; step > 0; step /= 2) value = max(value, __shfl_xor_sync(k_warp, value, step));
  return value;
#endif
}

__device__ inline int warp_sum(int value) {
#if __CUDA_ARCH__ >= 800
  return __reduce_add_sync(k_warp, value);
#else
  for (int step = 16; step > 0; step /= 2) value += __shfl_xor_sync(k_warp, value, step);
  return value;
#endif
}

/// Returns the sum of what the lanes up to this one have.
__device__ inline int warp_sum_through(int value) {
  const int lane = threadIdx.x & 31;
#pragma unroll
  for (int step = 1; step < 32; step *= 2) {
    const int before = __shfl_up_sync(k_warp, value, step);
    value += lane >= step ? before : 0;
  }
  return value;
}

}  // namespace saddleback
