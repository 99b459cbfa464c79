#pragma once
// Boxes about every 32 sites in their order, about every 32 of those, and so on.

#include "support/cuda/device_buffer.h"
#include "support/cuda/warp.cuh"
#include "voronoi2d/cuda/device_order.cuh"

namespace saddleback::voronoi2d {
namespace {

struct __align__(16) DeviceBox {
  double low[2], high[2];

  __device__ bool meets(const DeviceBox& other) const {
    return low[0] <= other.high[0] && other.low[0] <= high[0] && low[1] <= other.high[1] && other.low[1] <= high[1];
  }
  __device__ bool contains(double x, double y) const {
    return x >= low[0] && x <= high[0] && y >= low[1] && y <= high[1];
  }
  __device__ double square_distance(double x, double y) const {
    const double dx = fmax(fmax(low[0] - x, x - high[0]), 0.0), dy = fmax(fmax(low[1] - y, y - high[1]), 0.0);
    return dx * dx + dy * dy;
  }
};

struct DeviceTree {
  static constexpr int k_most_levels = 7;  ///< 32^7 sites are more than an index can tell
  const double2* sites;
  const DeviceBox* boxes[k_most_levels];
  std::int32_t counts[k_most_levels];  ///< level 0 holds the boxes of sites; the last has at most 32
  std::int32_t site_count;
  int levels;
};

/// Says where a box comes among others; nowhere, when it is not to be visited.
constexpr unsigned k_nowhere = ~0u;
/// The least comes first. What is no number comes somewhere.
__device__ inline unsigned place_by(double number) {
  const unsigned bits = __float_as_uint(static_cast<float>(number));
  return min(bits & 0x80000000u ? ~bits : bits | 0x80000000u, k_nowhere - 1);
}

/// Says what a visit makes of boxes' places: they are as before, or are to be asked for again, or no more are to be
/// visited.
enum class Seen { as_before, anew, enough };

/// Calls, for a whole warp, visit(rank of the lane's site, or -1, load(rank)) for every 32 sites in a row, as long as
/// place(level, box) is somewhere for all boxes about them; of each 32 the first comes first. Where visits change
/// nothing, places are not asked for again, and the sites of several boxes are loaded at a time: else each would wait
/// for memory.
template <int AtOnce, class Place, class Load, class Visit>
__device__ void visit_leaves(const DeviceTree& tree, Place&& place, Load&& load, Visit&& visit) {
  const int lane = threadIdx.x % 32;
  int level = tree.levels - 1;
  unsigned open[DeviceTree::k_most_levels];  // children not visited yet; the same in all lanes
  std::int32_t node[DeviceTree::k_most_levels];
  open[level] = k_warp;
  node[level] = 0;
  unsigned placed_levels = 0;  // bits: those whose open children are all to be visited, as far as is known
  const auto take_open = [&] {
    const int first = __ffs(static_cast<int>(open[level])) - 1;
    open[level] &= open[level] - 1;
    return node[level] * 32 + first;
  };
  while (level < tree.levels) {
    const bool are_placed = (placed_levels >> level & 1) != 0;
    std::int32_t next;
    if (are_placed) {
      if (open[level] == 0) {
        ++level;
        continue;
      }
      next = take_open();
    } else {
      const std::int32_t child = node[level] * 32 + lane;
      unsigned mine = k_nowhere;
      if ((open[level] >> lane & 1) && child < tree.counts[level]) mine = place(level, child);
      const unsigned those = __ballot_sync(k_warp, mine != k_nowhere);
      if (those == 0) {
        ++level;
        continue;
      }
      const unsigned least = warp_min(mine);
      const int chosen = __ffs(static_cast<int>(__ballot_sync(k_warp, mine == least))) - 1;
      open[level] = those & ~(1u << chosen);
      placed_levels |= 1u << level;
      next = node[level] * 32 + chosen;
    }
    if (level > 0) {
      --level;
      open[level] = k_warp;
      node[level] = next;
      placed_levels &= ~(1u << level);
      continue;
    }
    std::int32_t sites[AtOnce];
    decltype(load(0)) loaded[AtOnce];
    int count = 0;
#pragma unroll
    for (int k = 0; k < AtOnce; ++k) {
      const bool is_one = k == 0 || (are_placed && open[0] != 0);
      if (k > 0 && is_one) next = take_open();
      sites[k] = is_one && next * 32 + lane < tree.site_count ? next * 32 + lane : -1;
      loaded[k] = load(sites[k]);
      count += is_one;
    }
#pragma unroll 1
    for (; count > 0; --count) {
      const Seen seen = visit(sites[0], loaded[0]);
      if (seen == Seen::enough) return;
      if (seen == Seen::anew) placed_levels = 0;
#pragma unroll
      for (int k = 0; k + 1 < AtOnce; ++k) {  // so that there is one visit in the code
        sites[k] = sites[k + 1];
        loaded[k] = loaded[k + 1];
      }
    }
  }
}

/// Does the same as long as measure(level, box) is not negative, the least first. Every visit may make it so; ends when
/// visit(rank) is false.
template <class Measure, class Visit>
__device__ void visit_leaves(const DeviceTree& tree, Measure&& measure, Visit&& visit) {
  const auto place = [&](int level, std::int32_t child) {
    const double measured = measure(level, child);
    return measured >= 0 ? place_by(measured) : k_nowhere;
  };
  visit_leaves<1>(
      tree, place, [](std::int32_t) { return 0; },
      [&](std::int32_t site, int) { return visit(site) ? Seen::anew : Seen::enough; });
}

__device__ inline DeviceBox joined(DeviceBox box) {
  for (int step = 16; step > 0; step /= 2) {
    for (int k = 0; k < 2; ++k) {
      box.low[k] = fmin(box.low[k], __shfl_xor_sync(k_warp, box.low[k], step));
      box.high[k] = fmax(box.high[k], __shfl_xor_sync(k_warp, box.high[k], step));
    }
  }
  return box;
}

__global__ void box_sites(const double2* sites, std::int32_t count, DeviceBox* boxes) {
  const std::int32_t i = thread_number();
  const double2 p = sites[min(i, count - 1)];
  const DeviceBox box = joined({{p.x, p.y}, {p.x, p.y}});
  if (i % 32 == 0 && i < count) boxes[i / 32] = box;
}

__global__ void box_boxes(const DeviceBox* inner, std::int32_t count, DeviceBox* boxes) {
  const std::int32_t i = thread_number();
  const DeviceBox box = joined(inner[min(i, count - 1)]);
  if (i % 32 == 0 && i < count) boxes[i / 32] = box;
}

class BoxLevels {
 public:
  BoxLevels(const double2* sites, std::int32_t count, cudaStream_t stream) {
    tree_.sites = sites;
    tree_.site_count = count;
    std::size_t total = 0;
    for (std::int32_t inner = count; tree_.levels == 0 || inner > 32;) {
      inner = (inner + 31) / 32;
      tree_.counts[tree_.levels++] = inner;
      total += static_cast<std::size_t>(inner);
    }
    boxes_ = DeviceBuffer<DeviceBox>(total, stream);
    DeviceBox* to = boxes_.data();
    for (int level = 0; level < tree_.levels; ++level) {
      if (level == 0) {
        box_sites<<<blocks_for(count), k_threads, 0, stream>>>(sites, count, to);
      } else {
        const std::int32_t inner = tree_.counts[level - 1];
        box_boxes<<<blocks_for(inner), k_threads, 0, stream>>>(tree_.boxes[level - 1], inner, to);
      }
      check_cuda(cudaGetLastError(), "boxing sites");
      tree_.boxes[level] = to;
      to += tree_.counts[level];
    }
  }
  const DeviceTree& tree() const { return tree_; }

 private:
  DeviceTree tree_{};
  DeviceBuffer<DeviceBox> boxes_;
};

}  // namespace
}  // namespace saddleback::voronoi2d
