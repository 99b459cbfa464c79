#pragma once
// The exchange about sides between several devices: neighbors, and numbers of edges and vertices.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "support/cuda/device_buffer.h"
#include "support/cuda/device_launch.cuh"
#include "support/cuda/device_team.h"
#include "support/cuda/index_range.cuh"

namespace saddleback::voronoi2d {
namespace {

/// A side of all cells' rows, and what it is given: the neighbor, or the number of its edge or of the vertex behind
/// it.
struct NumberOfSide {
  std::int32_t side, number;
};

/// A list of sides with their numbers, in any order.
struct DeviceNumberList {
  NumberOfSide* items;
  unsigned* count;
  unsigned room;

  __device__ void add(std::int32_t side, std::int32_t number) const {
    const unsigned place = atomicAdd(count, 1u);
    if (place < room) items[place] = {side, number};
  }
};

__global__ void place_numbers(const NumberOfSide* items, std::int64_t count, IndexRange sides, std::int32_t* numbers) {
  const std::int64_t i = thread_number();
  if (i < count && sides.holds(items[i].side)) numbers[items[i].side] = items[i].number;
}

/// Holds what a member of a team tells the others: little, where parts are compact.
class NumbersElsewhere {
 public:
  NumbersElsewhere(std::int32_t own_sides, cudaStream_t stream)
      : stream_(stream),
        items_(own_sides == 0 ? 0 : static_cast<std::size_t>(own_sides) / k_of_as_many + k_few, stream),
        count_(1, stream) {}

  DeviceNumberList list() { return {items_.data(), count_.data(), static_cast<unsigned>(items_.size())}; }

  /// Calls number(), which lets kernels add to the list whatever there is, once more if there was too little room.
  /// Waits for the stream.
  template <class Number>
  void fill(Number&& number) {
    while (true) {
      count_.fill_bytes(0);
      number();
      found_ = count_.value_at(0);
      if (found_ <= items_.size()) return;
      items_ = DeviceBuffer<NumberOfSide>(found_, stream_);
    }
  }
  /// Writes to `numbers` what the other members know of these `sides`; all members call it. They wait for their streams
  /// before this goes away.
  void exchange(TeamArrays& arrays, int member, IndexRange sides, std::int32_t* numbers) {
    const auto lists = arrays.lists_of_all(member, std::span<const NumberOfSide>(items_.data(), found_));
    std::size_t most = 0;
    for (const auto& list : lists) most = std::max(most, list.items.size());
    DeviceBuffer<NumberOfSide> theirs(most, stream_);
    const auto own = static_cast<std::size_t>(member);
    for (std::size_t other = 0; other < lists.size(); ++other) {
      const std::span<const NumberOfSide> items = lists[other].items;
      if (other == own || items.empty()) continue;
      check_cuda(cudaMemcpyPeerAsync(theirs.data(), lists[own].device, items.data(), lists[other].device,
                                     items.size_bytes(), stream_),
                 "copying between devices");
      place_numbers<<<blocks_for(static_cast<std::int64_t>(items.size())), k_threads, 0, stream_>>>(
          theirs.data(), static_cast<std::int64_t>(items.size()), sides, numbers);
      check_cuda(cudaGetLastError(), "numbering sides");
    }
  }

 private:
  /// Guesses that one of this many sides is sent. Sending a few once more takes no time.
  static constexpr std::size_t k_of_as_many = 64, k_few = 64;
  cudaStream_t stream_;
  DeviceBuffer<NumberOfSide> items_;
  DeviceBuffer<unsigned> count_;
  unsigned found_ = 0;
};

}  // namespace
}  // namespace saddleback::voronoi2d
