#pragma once
// Tiles: the largest rectangles of the curve that hold no more sites than a block takes.

#include <cub/device/device_select.cuh>
#include <limits>
#include <thrust/iterator/counting_iterator.h>
#include <vector>

#include "voronoi2d/device_order.cuh"

namespace saddleback::voronoi2d {
namespace {

constexpr std::int32_t k_tile_sites = 160;

/// Marks the first rank of each tile. Rectangles shrink by half with each bit of the place.
__global__ void mark_tiles(const std::uint32_t* places, std::int32_t count, std::uint8_t* is_first) {
  const std::int32_t rank = thread_number();
  if (rank >= count) return;
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
  is_first[rank] = is_whole ? begin == rank : rank % k_tile_sites == 0 || begin == rank;
}

class Tiles {
 public:
  Tiles(const std::uint32_t* places, std::int32_t count, cudaStream_t stream)
      : begins_(static_cast<std::size_t>(count) + 1, stream), count_(1, stream) {
    DeviceBuffer<std::uint8_t> is_first(static_cast<std::size_t>(count), stream);
    mark_tiles<<<blocks_for(count), k_threads, 0, stream>>>(places, count, is_first.data());
    check_cuda(cudaGetLastError(), "making tiles");
    with_scratch(stream, "making tiles", [&](void* scratch, std::size_t& bytes) {
      return cub::DeviceSelect::Flagged(scratch, bytes, thrust::counting_iterator<std::int32_t>(0), is_first.data(),
                                        begins_.data(), count_.data(), count, stream);
    });
  }
  /// The tiles and sites that each of several parts has: where it begins, and where the last ends.
  struct Parts {
    std::vector<std::int32_t> tiles, sites;
  };
  Parts parts(int number, std::int32_t site_count) const {
    if (number == 1) return {{0, std::numeric_limits<std::int32_t>::max()}, {0, site_count}};  // as many as there are
    std::int32_t count = 0;
    count_.read({&count, 1});
    Parts parts;
    for (int i = 0; i < number; ++i) {
      parts.tiles.push_back(static_cast<std::int32_t>(static_cast<std::int64_t>(count) * i / number));
      parts.sites.push_back(begins_.value_at(static_cast<std::size_t>(parts.tiles.back())));
    }
    parts.tiles.push_back(count);
    parts.sites.push_back(site_count);
    return parts;
  }
  const std::int32_t* begins() const { return begins_.data(); }  ///< the end of the last is the number of sites
  const std::int32_t* count() const { return count_.data(); }

 private:
  DeviceBuffer<std::int32_t> begins_, count_;
};

}  // namespace
}  // namespace saddleback::voronoi2d
