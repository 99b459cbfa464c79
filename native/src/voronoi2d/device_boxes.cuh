#pragma once
// Boxes about every 32 sites in their order, about every 32 of those, and so on.

#include "support/device_buffer.h"
#include "support/warp.cuh"
#include "voronoi2d/device_order.cuh"

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

/// By a warp: calls visit(rank of the lane's site, or -1) for every 32 sites in a row, as long as all boxes about them
/// have a number from measure(level, box) that is not negative; of each 32 those with the least come first. Ends when
/// visit() is false.
template <class Measure, class Visit>
__device__ void visit_leaves(const DeviceTree& tree, Measure&& measure, Visit&& visit) {
  const int lane = threadIdx.x % 32;
  int level = tree.levels - 1;
  unsigned open[DeviceTree::k_most_levels];  // children not visited yet; the same in all lanes
  std::int32_t node[DeviceTree::k_most_levels];
  open[level] = k_warp;
  node[level] = 0;
  while (level < tree.levels) {
    const std::int32_t child = node[level] * 32 + lane;
    double measured = -1;
    if ((open[level] >> lane & 1) && child < tree.counts[level]) measured = measure(level, child);
    const unsigned those = __ballot_sync(k_warp, measured >= 0);
    if (those == 0) {
      ++level;
      continue;
    }
    const unsigned key = measured >= 0 ? __float_as_uint(static_cast<float>(measured)) : ~0u;
    const unsigned least = warp_min(key);
    const int chosen = __ffs(static_cast<int>(__ballot_sync(k_warp, measured >= 0 && key == least))) - 1;
    open[level] = those & ~(1u << chosen);
    const std::int32_t next = node[level] * 32 + chosen;
    if (level > 0) {
      --level;
      open[level] = k_warp;
      node[level] = next;
      continue;
    }
    const std::int32_t site = next * 32 + lane;
    if (!visit(site < tree.site_count ? site : -1)) return;
  }
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
