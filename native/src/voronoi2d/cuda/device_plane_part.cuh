#pragma once
// The part of a diagram that one of several devices finds, and what it learns of the others' parts.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "support/cuda/device_buffer.h"
#include "support/cuda/device_launch.cuh"
#include "support/cuda/device_scratch.cuh"
#include "support/cuda/device_team.h"
#include "support/cuda/index_range.cuh"

namespace saddleback::voronoi2d {
namespace {

__global__ void count_in_bytes(const std::int32_t* counts, IndexRange those, std::uint8_t* bytes, int* are_more) {
  const std::int32_t i = those.begin + thread_number();
  if (i >= those.end) return;
  if (counts[i] > 255) *are_more = 1;
  bytes[i] = static_cast<std::uint8_t>(counts[i]);
}

/// Puts in the place of each place the number there.
__global__ void pick(const std::int32_t* numbers, std::int32_t* places, std::int32_t count) {
  const std::int32_t i = thread_number();
  if (i < count) places[i] = numbers[places[i]];
}

/// A member of a team that finds one diagram: it has the cells from begins[member] to begins[member + 1].
struct PlanePart {
  TeamArrays& arrays;
  int member;
  std::vector<std::int32_t> begins;  ///< of all members' cells, and the end of the last

  bool is_all() const { return begins.size() == 2; }
  int members() const { return static_cast<int>(begins.size()) - 1; }
  IndexRange cells() const { return range(begins); }
  IndexRange range(std::span<const std::int32_t> bounds) const {
    return {bounds[static_cast<std::size_t>(member)], bounds[static_cast<std::size_t>(member) + 1]};
  }
  /// Returns where the members' parts of rows begin. Waits for the stream where there are several.
  std::vector<std::int32_t> rows(const DeviceBuffer<std::int32_t>& offsets, std::int32_t total,
                                 cudaStream_t stream) const {
    if (is_all()) return {0, total};
    std::vector<std::int32_t> bounds = begins;
    DeviceBuffer<std::int32_t> picked(bounds, stream);
    const auto count = static_cast<std::int32_t>(bounds.size());
    pick<<<blocks_for(count), k_threads, 0, stream>>>(offsets.data(), picked.data(), count);
    check_cuda(cudaGetLastError(), "looking for parts");
    picked.read(bounds);
    return bounds;
  }

  /// Adds up what all members have counted for their own cells: for each cell the sum of those before it. The last
  /// count is 0. Counts of less than 256, which nearly all are, go from device to device as bytes.
  void add_up_all(DeviceBuffer<std::int32_t>& counts, DeviceBuffer<std::int32_t>& sums, cudaStream_t stream) const {
    if (is_all()) return add_up(counts, sums, stream);
    DeviceBuffer<std::uint8_t> bytes(counts.size(), stream);
    DeviceBuffer<int> are_more(1, stream);
    bytes.fill_bytes(0);
    are_more.fill_bytes(0);
    count_in_bytes<<<blocks_for(cells().count()), k_threads, 0, stream>>>(counts.data(), cells(), bytes.data(),
                                                                          are_more.data());
    check_cuda(cudaGetLastError(), "counting");
    const std::vector<std::int64_t> more = arrays.numbers_of_all(member, are_more.value_at(0));
    if (std::ranges::all_of(more, [](std::int64_t each) { return each == 0; })) {
      arrays.share(member, bytes.data(), begins, stream);
      add_up(bytes, sums, stream);
    } else {
      arrays.share(member, counts.data(), begins, stream);
      add_up(counts, sums, stream);
    }
  }

  /// Adds up what a member has counted for its own cells: for each of them the sum of those before it, of its own. The
  /// count after the last is there, and so is the sum. \return where the members' sums begin, and what all are together
  std::vector<std::int32_t> add_up_own(const DeviceBuffer<std::int32_t>& counts, DeviceBuffer<std::int32_t>& sums,
                                       cudaStream_t stream) const {
    const IndexRange own = cells();
    add_up(counts.data() + own.begin, sums.data() + own.begin, own.count() + 1, stream);
    std::vector<std::int32_t> bounds{0};
    for (const std::int64_t sum : arrays.numbers_of_all(member, sums.value_at(static_cast<std::size_t>(own.end))))
      bounds.push_back(bounds.back() + static_cast<std::int32_t>(sum));
    return bounds;
  }
};

}  // namespace
}  // namespace saddleback::voronoi2d
