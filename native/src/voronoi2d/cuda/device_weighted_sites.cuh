#pragma once
// Weighted sites on the device: those that no other hides, with boxes about them that know the heaviest within.

#include <cub/device/device_select.cuh>
#include <thrust/iterator/counting_iterator.h>

#include "voronoi2d/cuda/device_boxes.cuh"
#include "voronoi2d/weighted/weighted_wave.h"

namespace saddleback::voronoi2d {
namespace {

using predicates::WeightedPoint2;

struct WeightedTree {
  DeviceTree boxes;
  const double* weights;                              ///< of the sites
  const double* heaviest[DeviceTree::k_most_levels];  ///< in the boxes

  __device__ WeightedPoint2 site(std::int32_t rank) const {
    const double2 p = boxes.sites[rank];
    return {p.x, p.y, weights[rank]};
  }
};

__device__ inline double heaviest_of_warp(double weight) {
  for (int step = 16; step > 0; step /= 2) weight = fmax(weight, __shfl_xor_sync(k_warp, weight, step));
  return weight;
}

__global__ void weigh_boxes(const double* inner, std::int32_t count, double* heaviest) {
  const std::int32_t i = thread_number();
  const double most = heaviest_of_warp(inner[min(i, count - 1)]);
  if (i % 32 == 0 && i < count) heaviest[i / 32] = most;
}

class WeightedBoxes {
 public:
  WeightedBoxes(const double2* sites, const double* weights, std::int32_t count, cudaStream_t stream)
      : levels_(sites, count, stream) {
    tree_.boxes = levels_.tree();
    tree_.weights = weights;
    std::size_t total = 0;
    for (int level = 0; level < tree_.boxes.levels; ++level)
      total += static_cast<std::size_t>(tree_.boxes.counts[level]);
    heaviest_ = DeviceBuffer<double>(total, stream);
    double* to = heaviest_.data();
    for (int level = 0; level < tree_.boxes.levels; ++level) {
      const std::int32_t inner = level == 0 ? count : tree_.boxes.counts[level - 1];
      weigh_boxes<<<blocks_for(inner), k_threads, 0, stream>>>(level == 0 ? weights : tree_.heaviest[level - 1], inner,
                                                               to);
      check_cuda(cudaGetLastError(), "weighing sites");
      tree_.heaviest[level] = to;
      to += tree_.boxes.counts[level];
    }
  }
  const WeightedTree& tree() const { return tree_; }

 private:
  BoxLevels levels_;
  WeightedTree tree_{};
  DeviceBuffer<double> heaviest_;
};

/// A bound on the relative rounding of a few operations.
constexpr double k_reach_slack = 1e-12;

__device__ inline double square_distance(const DeviceBox& a, const DeviceBox& b) {
  const double dx = fmax(fmax(a.low[0] - b.high[0], b.low[0] - a.high[0]), 0.0),
               dy = fmax(fmax(a.low[1] - b.high[1], b.low[1] - a.high[1]), 0.0);
  return dx * dx + dy * dy;
}

/// Finds the visible of sites at different places, a warp for each box of them. `doubts` counts those that doubles do
/// not tell.
__global__ void find_visible(WeightedTree tree, std::uint8_t* is_visible, int* doubts) {
  const std::int32_t own = thread_number(), box = own / 32;
  if (box >= tree.boxes.counts[0]) return;
  const std::int32_t rank = min(own, tree.boxes.site_count - 1);
  const WeightedPoint2 here = tree.site(rank);
  const double lightest = -heaviest_of_warp(-here.weight);
  const DeviceBox around = tree.boxes.boxes[0][box];
  bool is_hidden = false, is_doubtful = false;
  visit_leaves(
      tree.boxes,
      [&](int level, std::int32_t child) {
        const double reach = tree.heaviest[level][child] - lightest;
        const double away = square_distance(around, tree.boxes.boxes[level][child]);
        return reach >= 0 && away <= reach * reach * (1 + k_reach_slack) ? away : -1;
      },
      [&](std::int32_t site) {
        const WeightedPoint2 other = site >= 0 ? tree.site(site) : WeightedPoint2{0, 0, -INFINITY};
        for (int k = 0; k < 32; ++k) {
          const double weight = __shfl_sync(k_warp, other.weight, k), more = weight - here.weight;
          const double dx = __shfl_sync(k_warp, other.x, k) - here.x, dy = __shfl_sync(k_warp, other.y, k) - here.y;
          if (!(more > 0)) continue;
          const double terms = dx * dx + dy * dy + more * more, n = dx * dx + dy * dy - more * more;
          const double off = 6 * predicates::detail::k_epsilon * terms;
          is_hidden |= n < -off;
          is_doubtful |= fabs(n) <= off;
        }
        return true;
      });
  if (own >= tree.boxes.site_count) return;
  is_visible[own] = !is_hidden;
  if (is_doubtful && !is_hidden) atomicAdd(doubts, 1);
}

__global__ void gather_weights(const double* weights, const std::int32_t* original, std::int32_t count, double* to) {
  const std::int32_t rank = thread_number();
  if (rank < count) to[rank] = weights[original[rank]];
}

struct VisibleArrays {
  double2* at;
  std::int32_t *original, *cell_places;
  double* weights;
};

__global__ void gather_visible(const std::int32_t* ranks, std::int32_t count, const double2* at,
                               const std::int32_t* original, const double* weights, VisibleArrays to) {
  const std::int32_t i = thread_number();
  if (i >= count) return;
  const std::int32_t rank = ranks[i];
  to.at[i] = at[rank];
  to.original[i] = original[rank];
  to.weights[i] = weights[rank];
  to.cell_places[original[rank]] = i;
}

/// The sites that have cells, by rank among these.
class VisibleSites {
 public:
  /// Makes them of sites at different places, with weights by index. \throw LeftOver where doubles do not tell which
  /// are hidden.
  VisibleSites(const DeviceOrder& order, const double* weights, cudaStream_t stream) {
    const std::int32_t all = order.cell_count();
    const auto size = static_cast<std::size_t>(all);
    DeviceBuffer<double> ranked(size, stream);
    gather_weights<<<blocks_for(all), k_threads, 0, stream>>>(weights, order.original(), all, ranked.data());
    check_cuda(cudaGetLastError(), "ranking weights");
    const WeightedBoxes boxes(order.at(), ranked.data(), all, stream);
    DeviceBuffer<std::uint8_t> is_visible(size, stream);
    DeviceBuffer<int> counts(2, stream);  // of the visible, and of doubts
    counts.fill_bytes(0);
    find_visible<<<blocks_for(all), k_threads, 0, stream>>>(boxes.tree(), is_visible.data(), counts.data() + 1);
    check_cuda(cudaGetLastError(), "finding hidden sites");
    DeviceBuffer<std::int32_t> ranks(size, stream);
    with_scratch(stream, "listing visible sites", [&](void* scratch, std::size_t& bytes) {
      return cub::DeviceSelect::Flagged(scratch, bytes, thrust::counting_iterator<std::int32_t>(0), is_visible.data(),
                                        ranks.data(), counts.data(), all, stream);
    });
    int found[2];
    counts.read(found);
    if (found[1] > 0) throw LeftOver();
    count_ = found[0];
    at_ = DeviceBuffer<double2>(static_cast<std::size_t>(count_), stream);
    original_ = DeviceBuffer<std::int32_t>(static_cast<std::size_t>(count_), stream);
    weights_ = DeviceBuffer<double>(static_cast<std::size_t>(count_), stream);
    cell_places_ = DeviceBuffer<std::int32_t>(size, stream);
    constexpr int k_no_cell = 0xff;
    cell_places_.fill_bytes(k_no_cell);
    gather_visible<<<blocks_for(count_), k_threads, 0, stream>>>(
        ranks.data(), count_, order.at(), order.original(), ranked.data(),
        {at_.data(), original_.data(), cell_places_.data(), weights_.data()});
    check_cuda(cudaGetLastError(), "gathering visible sites");
  }

  std::int32_t count() const { return count_; }
  const double2* at() const { return at_.data(); }
  const double* weights() const { return weights_.data(); }
  const std::int32_t* original() const { return original_.data(); }
  const std::int32_t* cell_places() const { return cell_places_.data(); }  ///< by index

 private:
  std::int32_t count_ = 0;
  DeviceBuffer<double2> at_;
  DeviceBuffer<std::int32_t> original_, cell_places_;
  DeviceBuffer<double> weights_;
};

}  // namespace
}  // namespace saddleback::voronoi2d
