#pragma once
// What cub does with memory for the time being.

#include <cstddef>
#include <cstdint>
#include <cub/device/device_scan.cuh>

#include "support/device_buffer.h"

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

/// Of each number the sum of those before it.
template <class Number>
void add_up(const DeviceBuffer<Number>& counts, DeviceBuffer<Number>& sums, cudaStream_t stream) {
  const auto count = static_cast<int>(counts.size());
  with_scratch(stream, "adding up", [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceScan::ExclusiveSum(scratch, bytes, counts.data(), sums.data(), count, stream);
  });
}

}  // namespace
}  // namespace saddleback
