#pragma once
// Distinct sites along the curve, on the device: the CUDA counterpart of site_order and curve_order.

#include <algorithm>
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>
#include <utility>
#include <vector>

#include "support/cuda/device_buffer.h"
#include "support/cuda/device_launch.cuh"
#include "support/cuda/device_scratch.cuh"
#include "support/cuda/index_range.cuh"
#include "support/cuda/warp.cuh"
#include "voronoi2d/cuda/device_kept.cuh"
#include "voronoi2d/sites/curve_place.h"

namespace saddleback::voronoi2d {
namespace {

struct Extent {
  double low[2], high[2];
  double smallest, largest;  ///< magnitudes other than 0
  int is_finite;

  __host__ __device__ void add(const Extent& other) {
    for (int k = 0; k < 2; ++k) {
      low[k] = fmin(low[k], other.low[k]);
      high[k] = fmax(high[k], other.high[k]);
    }
    smallest = fmin(smallest, other.smallest);
    largest = fmax(largest, other.largest);
    is_finite &= other.is_finite;
  }
  __host__ __device__ double half_width() const {
    return fmax(0.5 * high[0] - 0.5 * low[0], 0.5 * high[1] - 0.5 * low[1]);
  }
};
constexpr Extent k_nothing{{INFINITY, INFINITY}, {-INFINITY, -INFINITY}, INFINITY, 0, 1};

/// Holds what the host learns of the sites in one copy.
struct SitesSeen {
  Extent extent;
  int has_full_squares, has_equals;
};

/// Gives thread 0 the extent of what all threads of the block have.
__device__ inline Extent extent_of_block(Extent mine) {
  __shared__ Extent shared[k_threads / 32];
  const auto gather = [&](int lanes) {
    for (int step = lanes / 2; step > 0; step /= 2) {
      Extent other;
      for (int k = 0; k < 2; ++k) {
        other.low[k] = __shfl_down_sync(0xffffffffu, mine.low[k], step);
        other.high[k] = __shfl_down_sync(0xffffffffu, mine.high[k], step);
      }
      other.smallest = __shfl_down_sync(0xffffffffu, mine.smallest, step);
      other.largest = __shfl_down_sync(0xffffffffu, mine.largest, step);
      other.is_finite = __shfl_down_sync(0xffffffffu, mine.is_finite, step);
      mine.add(other);
    }
  };
  gather(32);
  if (threadIdx.x % 32 == 0) shared[threadIdx.x / 32] = mine;
  __syncthreads();
  if (threadIdx.x < 32) {
    mine = threadIdx.x < k_threads / 32 ? shared[threadIdx.x] : k_nothing;
    gather(32);
  }
  return mine;
}

__global__ void __launch_bounds__(k_threads) measure(const double2* sites, std::int32_t count, Extent* parts) {
  Extent mine = k_nothing;
  for (std::int64_t i = thread_number(); i < count; i += static_cast<std::int64_t>(gridDim.x) * blockDim.x) {
    const double2 p = sites[i];
    const double x = fabs(p.x), y = fabs(p.y), none = INFINITY;
    mine.add({{p.x, p.y},
              {p.x, p.y},
              fmin(x == 0 ? none : x, y == 0 ? none : y),
              fmax(x, y),
              isfinite(p.x) && isfinite(p.y)});
  }
  mine = extent_of_block(mine);
  if (threadIdx.x == 0) parts[blockIdx.x] = mine;
}

/// One block.
__global__ void __launch_bounds__(k_threads) see_all(const Extent* parts, std::int32_t count, SitesSeen* seen) {
  Extent all = k_nothing;
  for (std::int32_t i = thread_number(); i < count; i += k_threads) all.add(parts[i]);
  all = extent_of_block(all);
  if (threadIdx.x == 0) *seen = {all, 0, 0};
}

/// Writes each site's place on the curve; any place where sites are not finite or all the same.
__global__ void place_sites(const double2* sites, std::int32_t count, const SitesSeen* seen, std::uint32_t* places,
                            std::int32_t* order) {
  const std::int32_t i = thread_number();
  if (i >= count) return;
  const double2 p = sites[i];
  const Extent& extent = seen->extent;
  const double half_width = extent.half_width();
  places[i] = place_of_square(square_of(p.x, extent.low[0], half_width), square_of(p.y, extent.low[1], half_width));
  order[i] = i;
}

/// Sites that share a square, by x, y and index. Of more than a few the processor makes a finer curve.
constexpr int k_few = 48;
__global__ void sort_squares(const double2* sites, std::int32_t count, const std::uint32_t* places, std::int32_t* order,
                             SitesSeen* seen) {
  const std::int32_t begin = thread_number();
  if (begin >= count || (begin > 0 && places[begin - 1] == places[begin])) return;
  std::int32_t end = begin + 1;
  while (end < count && end - begin <= k_few && places[end] == places[begin]) ++end;
  if (end - begin > k_few) {
    seen->has_full_squares = 1;
    return;
  }
  const auto less = [&](std::int32_t a, std::int32_t b) {
    const double2 p = sites[a], q = sites[b];
    if (p.x != q.x) return p.x < q.x;
    return p.y != q.y ? p.y < q.y : a < b;
  };
  for (std::int32_t i = begin + 1; i < end; ++i) {
    const std::int32_t moved = order[i];
    std::int32_t to = i;
    for (; to > begin && less(moved, order[to - 1]); --to) order[to] = order[to - 1];
    order[to] = moved;
  }
}

/// Sites in their order, which of them differ from the one before, and whether any does not.
__global__ void gather_sites(const double2* sites, std::int32_t count, const std::int32_t* order, double2* sorted,
                             std::int32_t* is_first, SitesSeen* seen) {
  const std::int32_t i = thread_number();
  const int lane = threadIdx.x % 32;
  const double2 p = sites[order[min(i, count - 1)]];
  double2 before{__shfl_up_sync(k_warp, p.x, 1), __shfl_up_sync(k_warp, p.y, 1)};
  if (i >= count) return;
  if (lane == 0 && i > 0) before = sites[order[i - 1]];
  const bool differs = i == 0 || p.x != before.x || p.y != before.y;
  sorted[i] = p;
  is_first[i] = differs;
  if (!differs) seen->has_equals = 1;
}

/// Holds what the processor keeps of the sites, by rank.
struct RankedSites {
  double2* at;
  std::int32_t* original;
  std::uint32_t* places;
};

__global__ void rank_sites(const double2* sorted, std::int32_t count, const std::int32_t* order,
                           const std::uint32_t* places, const std::int32_t* firsts_up_to, RankedSites ranked) {
  const std::int32_t i = thread_number();
  if (i >= count) return;
  const std::int32_t rank = firsts_up_to[i] - 1;
  if (i > 0 && firsts_up_to[i - 1] == rank + 1) return;
  ranked.at[rank] = sorted[i];
  ranked.original[rank] = order[i];
  ranked.places[rank] = places[i];
}

/// Finds where sites are, by index, for those of `share`.
__global__ void find_equals(std::int32_t count, const std::int32_t* order, const std::int32_t* firsts_up_to,
                            const std::int32_t* original, IndexRange share, std::int32_t* site_of,
                            std::int32_t* cell_places) {
  const std::int32_t i = thread_number();
  if (i >= count || !share.holds(order[i])) return;
  const std::int32_t rank = firsts_up_to[i] - 1;
  site_of[order[i]] = original[rank];
  cell_places[order[i]] = rank;
}

/// Does the same where no two are equal.
__global__ void place_distinct(std::int32_t count, const std::int32_t* order, IndexRange share, std::int32_t* site_of,
                               std::int32_t* cell_places) {
  const std::int32_t i = thread_number();
  if (i >= count) return;
  if (share.holds(i)) site_of[i] = i;
  if (share.holds(order[i])) cell_places[order[i]] = i;
}

/// The sites by rank, and for every site the rank of its place.
class DeviceOrder {
 public:
  DeviceOrder(std::int32_t count, cudaStream_t stream) : stream_(stream), count_(count), at_(size(), stream) {}

  enum class Found { order, not_for_the_device };

  /// Finds where the sites of `share` are as well, see site_of. sort(places, order) is the processor's, see
  /// DiagramCaller; it may throw.
  template <class Sort>
  Found find(const double2* sites, IndexRange share, Sort&& sort) {
    DeviceBuffer<SitesSeen> seen(1, stream_);
    see(sites, seen.data());
    DeviceBuffer<std::uint32_t> places(size(), stream_);
    DeviceBuffer<std::int32_t> order(size(), stream_), firsts(size(), stream_);
    {
      DeviceBuffer<std::uint32_t> unsorted_places(size(), stream_);
      DeviceBuffer<std::int32_t> unsorted(size(), stream_);
      place_sites<<<blocks_for(count_), k_threads, 0, stream_>>>(sites, count_, seen.data(), unsorted_places.data(),
                                                                 unsorted.data());
      check_cuda(cudaGetLastError(), "placing sites");
      with_scratch(stream_, "sorting sites", [&](void* scratch, std::size_t& bytes) {
        return cub::DeviceRadixSort::SortPairs(scratch, bytes, unsorted_places.data(), places.data(), unsorted.data(),
                                               order.data(), count_, 0, 2 * k_curve_bits, stream_);
      });
    }
    sort_squares<<<blocks_for(count_), k_threads, 0, stream_>>>(sites, count_, places.data(), order.data(),
                                                                seen.data());
    check_cuda(cudaGetLastError(), "sorting sites");
    // Few sites are such that this was in vain: what was seen so far is not waited for.
    SitesSeen found = gather(sites, order, firsts, seen);
    const Extent& extent = found.extent;
    // Beyond that the processor scales the sites, or says what is wrong with them.
    constexpr double k_largest = 0x1p250, k_smallest = 0x1p-216;
    if (!extent.is_finite || extent.largest >= k_largest || extent.smallest < k_smallest || !(extent.half_width() > 0))
      return Found::not_for_the_device;
    if (found.has_full_squares) {
      std::vector<std::uint32_t> sorted_places(size());
      std::vector<std::int32_t> sorted(size());
      sort(sorted_places.data(), sorted.data());
      places = DeviceBuffer<std::uint32_t>(sorted_places, stream_);
      order = DeviceBuffer<std::int32_t>(sorted, stream_);
      found = gather(sites, order, firsts, seen);
    }
    cell_count_ = count_;
    if (found.has_equals) {
      with_scratch(stream_, "counting sites", [&](void* scratch, std::size_t& bytes) {
        return cub::DeviceScan::InclusiveSum(scratch, bytes, firsts.data(), firsts.data(), count_, stream_);
      });
      cell_count_ = firsts.value_at(size() - 1);
    }
    rank(std::move(places), std::move(order), firsts, share);
    return Found::order;
  }

  void hand_over(KeptPlane& to) {
    to.site_of = std::move(site_of_);
    to.cell_places = std::move(cell_places_);
    to.cell_sites = std::move(original_);
  }
  std::int32_t cell_count() const { return cell_count_; }
  const double2* at() const { return at_.data(); }
  const std::int32_t* original() const { return original_.data(); }
  const std::uint32_t* places() const { return ranked_places_.data(); }
  /// Returns them by index; of the share that was asked for.
  const std::int32_t* site_of() const { return site_of_.data(); }
  const std::int32_t* cell_places() const { return cell_places_.data(); }

 private:
  std::size_t size() const { return static_cast<std::size_t>(count_); }

  /// Ranks from all sites to those that have cells.
  void rank(DeviceBuffer<std::uint32_t> places, DeviceBuffer<std::int32_t> order,
            const DeviceBuffer<std::int32_t>& firsts, IndexRange share) {
    const unsigned blocks = blocks_for(count_);
    if (share.count() > 0) {
      site_of_ = DeviceBuffer<std::int32_t>(size(), stream_);
      cell_places_ = DeviceBuffer<std::int32_t>(size(), stream_);
    }
    if (cell_count_ == count_) {
      original_ = std::move(order);
      ranked_places_ = std::move(places);
      if (share.count() > 0)
        place_distinct<<<blocks, k_threads, 0, stream_>>>(count_, original_.data(), share, site_of_.data(),
                                                          cell_places_.data());
    } else {
      DeviceBuffer<double2> ranked(size(), stream_);
      original_ = DeviceBuffer<std::int32_t>(size(), stream_);
      ranked_places_ = DeviceBuffer<std::uint32_t>(size(), stream_);
      rank_sites<<<blocks, k_threads, 0, stream_>>>(at_.data(), count_, order.data(), places.data(), firsts.data(),
                                                    {ranked.data(), original_.data(), ranked_places_.data()});
      at_ = std::move(ranked);
      if (share.count() > 0)
        find_equals<<<blocks, k_threads, 0, stream_>>>(count_, order.data(), firsts.data(), original_.data(), share,
                                                       site_of_.data(), cell_places_.data());
    }
    check_cuda(cudaGetLastError(), "ranking sites");
  }

  void see(const double2* sites, SitesSeen* seen) const {
    const unsigned blocks = std::min(blocks_for(count_), 1024u);
    DeviceBuffer<Extent> parts(blocks, stream_);
    measure<<<blocks, k_threads, 0, stream_>>>(sites, count_, parts.data());
    see_all<<<1, k_threads, 0, stream_>>>(parts.data(), static_cast<std::int32_t>(blocks), seen);
    check_cuda(cudaGetLastError(), "measuring the sites");
  }

  /// \return what was seen, equal sites too. Waits for the stream.
  SitesSeen gather(const double2* sites, const DeviceBuffer<std::int32_t>& order, DeviceBuffer<std::int32_t>& firsts,
                   DeviceBuffer<SitesSeen>& seen) {
    gather_sites<<<blocks_for(count_), k_threads, 0, stream_>>>(sites, count_, order.data(), at_.data(), firsts.data(),
                                                                seen.data());
    check_cuda(cudaGetLastError(), "finding equal sites");
    return seen.value_at(0);
  }

  cudaStream_t stream_;
  std::int32_t count_, cell_count_ = 0;
  DeviceBuffer<double2> at_;
  DeviceBuffer<std::int32_t> original_, site_of_, cell_places_;
  DeviceBuffer<std::uint32_t> ranked_places_;
};

}  // namespace
}  // namespace saddleback::voronoi2d
