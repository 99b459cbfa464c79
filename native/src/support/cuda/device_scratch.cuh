#pragma once
// Scratch memory for calls of cub.

#include <cstddef>
#include <cstdint>
#include <cub/device/device_scan.cuh>
#include <thrust/iterator/transform_iterator.h>
#include <type_traits>

#include "support/cuda/device_buffer.h"

namespace saddleback {
namespace {

/// Calls cub's function(scratch, bytes) twice: for the size of its memory, and to work.
template <class Function>
void with_scratch(cudaStream_t stream, const char* doing, Function&& function) {
  std::size_t bytes = 0;
  check_cuda(function(nullptr, bytes), doing);
  DeviceBuffer<std::uint8_t> scratch(bytes, stream);
  check_cuda(function(static_cast<void*>(scratch.data()), bytes), doing);
}

template <class Sum>
struct Widened {
  template <class Number>
  __host__ __device__ Sum operator()(Number number) const {
    return number;
  }
};

/// Writes of each of so many numbers the sum of those before it.
template <class Number, class Sum>
void add_up(const Number* counts, Sum* sums, std::int32_t count, cudaStream_t stream) {
  const auto add = [&](auto numbers) {
    with_scratch(stream, "adding up", [&](void* scratch, std::size_t& bytes) {
      return cub::DeviceScan::ExclusiveSum(scratch, bytes, numbers, sums, count, stream);
    });
  };
  if constexpr (std::is_same_v<Number, Sum>) {
    add(counts);
  } else {  // as sums, or they would be added up as what they are
    add(thrust::transform_iterator<Widened<Sum>, const Number*>(counts, {}));
  }
}
template <class Number, class Sum>
void add_up(const DeviceBuffer<Number>& counts, DeviceBuffer<Sum>& sums, cudaStream_t stream) {
  add_up(counts.data(), sums.data(), static_cast<std::int32_t>(counts.size()), stream);
}

}  // namespace
}  // namespace saddleback
