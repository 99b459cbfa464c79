#pragma once
// Tiles: the largest rectangles of the curve that hold no more sites than a block takes.

#include <cub/device/device_select.cuh>
#include <thrust/iterator/counting_iterator.h>
#include <vector>

#include "voronoi2d/cuda/device_order.cuh"

namespace saddleback::voronoi2d {
namespace {

constexpr std::int32_t k_tile_sites = 160;

/// Tells whether a rank is the first of its tile. Rectangles shrink by half with each bit of the place.
__device__ inline bool begins_tile(const std::uint32_t* places, std::int32_t count, std::int32_t rank) {
  const std::uint32_t mine = places[rank];
  // The first of the ranks from `from` on, at most `rank`, whose place agrees with mine down to a bit.
  const auto begin_at = [&](int bits) {
    std::int32_t low = max(0, rank - k_tile_sites), high = rank;
    while (low < high) {
      const std::int32_t middle = low + (high - low) / 2;
      if (places[middle] >> bits == mine >> bits) {
        high = middle;
      } else {
        low = middle + 1;
      }
    }
    return low;
  };
  const auto end_at = [&](int bits) {
    std::int32_t low = rank, high = min(count, rank + k_tile_sites + 1);
    while (low < high) {
      const std::int32_t middle = low + (high - low) / 2;
      if (places[middle] >> bits == mine >> bits) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return low;
  };
  int low_bits = 0, high_bits = 2 * k_curve_bits - 1;  // the most bits to leave out with few enough sites
  while (low_bits < high_bits) {
    const int bits = (low_bits + high_bits + 1) / 2;
    if (end_at(bits) - begin_at(bits) <= k_tile_sites) {
      low_bits = bits;
    } else {
      high_bits = bits - 1;
    }
  }
  const std::int32_t begin = begin_at(low_bits);
  const bool is_whole = end_at(low_bits) - begin <= k_tile_sites;
  return is_whole ? begin == rank : rank % k_tile_sites == 0 || begin == rank;
}

__global__ void mark_tiles(const std::uint32_t* places, std::int32_t count, IndexRange ranks, std::uint8_t* is_first) {
  const std::int32_t i = thread_number();
  if (i < ranks.count()) is_first[i] = begins_tile(places, count, ranks.begin + i);
}

/// The first tile that begins at one of several ranks or after it; a block for each.
__global__ void find_next_tiles(const std::uint32_t* places, std::int32_t count, std::int32_t* ranks) {
  static_assert(k_threads > k_tile_sites);  // as far as it can be
  const std::int32_t from = ranks[blockIdx.x], rank = from + static_cast<std::int32_t>(threadIdx.x);
  __syncthreads();
  if (threadIdx.x == 0) ranks[blockIdx.x] = count;
  __syncthreads();
  if (rank < count && begins_tile(places, count, rank)) atomicMin(&ranks[blockIdx.x], rank);
}

/// The tiles of one of several parts of about as many sites.
class Tiles {
 public:
  Tiles(const std::uint32_t* places, std::int32_t count, int part, int parts, cudaStream_t stream)
      : bounds_(bounds(places, count, parts, stream)), count_(1, stream) {
    const IndexRange mine{bounds_[static_cast<std::size_t>(part)], bounds_[static_cast<std::size_t>(part) + 1]};
    const auto ranks = static_cast<std::size_t>(mine.count());
    begins_ = DeviceBuffer<std::int32_t>(ranks + 1, stream);
    DeviceBuffer<std::uint8_t> is_first(ranks + 1, stream);
    mark_tiles<<<blocks_for(mine.count()), k_threads, 0, stream>>>(places, count, mine, is_first.data());
    check_cuda(cudaGetLastError(), "making tiles");
    with_scratch(stream, "making tiles", [&](void* scratch, std::size_t& bytes) {
      return cub::DeviceSelect::Flagged(scratch, bytes, thrust::counting_iterator<std::int32_t>(mine.begin),
                                        is_first.data(), begins_.data(), count_.data(), mine.count(), stream);
    });
  }
  /// Returns where the sites of each part begin, and where the last ends.
  const std::vector<std::int32_t>& bounds() const { return bounds_; }
  const std::int32_t* begins() const { return begins_.data(); }
  const std::int32_t* count() const { return count_.data(); }

 private:
  static std::vector<std::int32_t> bounds(const std::uint32_t* places, std::int32_t count, int parts,
                                          cudaStream_t stream) {
    std::vector<std::int32_t> bounds;
    for (std::int64_t i = 1; i < parts; ++i) bounds.push_back(static_cast<std::int32_t>(count * i / parts));
    if (parts > 1) {
      DeviceBuffer<std::int32_t> found(bounds, stream);
      find_next_tiles<<<static_cast<unsigned>(parts - 1), k_threads, 0, stream>>>(places, count, found.data());
      check_cuda(cudaGetLastError(), "dividing tiles");
      found.read(bounds);
    }
    bounds.insert(bounds.begin(), 0);
    bounds.push_back(count);
    return bounds;
  }

  std::vector<std::int32_t> bounds_;
  DeviceBuffer<std::int32_t> begins_, count_;
};

}  // namespace
}  // namespace saddleback::voronoi2d
