#pragma once
// The cells of weighted sites, of 32 in a row at once: a block looks for all that may matter to them, if their cells
// are not larger than usual, and each of its warps builds some. A cell that cannot be found so is left to
// `device_weighted_far_cells.cuh`.

#include "voronoi2d/cuda/device_envelope.cuh"

namespace saddleback::voronoi2d {
namespace {

constexpr int k_row_threads = 128, k_row_warps = k_row_threads / 32;

struct RowMemory {
  static constexpr int k_near = 384, k_chosen = 96;
  double x[k_near], y[k_near], weight[k_near];
  std::int32_t rank[k_near];
  std::uint16_t chosen[k_row_warps][k_chosen];  ///< for the cell of a warp
  int near_count;
  double margin;  ///< of the box about the row: no other site's disk is nearer to it
  int box;
};

/// Some of the sites near a row, as one of the row sees them: three a lane, and the infinitely far, which comes first.
class ChosenWaves {
 public:
  __device__ ChosenWaves(const RowMemory& memory, std::uint16_t* chosen, const WeightedPoint2& here)
      : memory_(memory), chosen_(chosen), here_(here) {}

  /// Chooses the sites, other than the one of rank `own`, that may cut off its cell within half of `far`. False when
  /// there are too many.
  __device__ bool choose(std::int32_t own, double far) {
    const int lane = threadIdx.x % 32;
    count_ = 1;
    __syncwarp();
    for (int first = 0; first < memory_.near_count; first += 32) {
      const int k = first + lane;
      bool is_in = false;
      if (k < memory_.near_count) {
        const double dx = memory_.x[k] - here_.x, dy = memory_.y[k] - here_.y;
        const double reach = far + (memory_.weight[k] - here_.weight);
        is_in = reach > 0 && dx * dx + dy * dy < reach * reach * (1 + k_reach_slack) && memory_.rank[k] != own;
      }
      const unsigned those = __ballot_sync(k_warp, is_in);
      const int at = count_ + __popc(those & ((1u << lane) - 1));
      if (is_in && at < RowMemory::k_chosen) chosen_[at] = static_cast<std::uint16_t>(k);
      count_ += __popc(those);
    }
    if (count_ > RowMemory::k_chosen) return false;
    __syncwarp();
    for (int j = 0; j < k_each; ++j)
      if (32 * j + lane < count_) mine_[j] = wave(32 * j + lane);
    return true;
  }

  __device__ int highest(const Direction& u) const {
    Least least;
    for_mine([&](int at, const Wave& wave) {
      const double height = wave.x * u.x + wave.y * u.y + wave.z;
      least.take(-height, 2 * (wave.doubt + wave.size * (u.blur + 0x1p-50)), at);
    });
    const int lane = least.lane();
    return lane < 0 ? k_unknown_rival : __shfl_sync(k_warp, least.at, lane);
  }

  __device__ Wave wave(int at) const {
    return at == 0 ? Wave{0, 0, 0, 0, 0} : careful_wave(here_, {x(at), y(at), memory_.weight[chosen_[at]]});
  }
  __device__ std::int32_t rank(int at) const { return at == 0 ? -1 : memory_.rank[chosen_[at]]; }

  __device__ Rise next(int present_at, const Wave& present, const Direction& from) const {
    Least least;
    bool is_certain = true;
    for_mine([&](int at, const Wave& wave) {
      if (at != present_at) is_certain = take_rise(present, from, wave, at, least) && is_certain;
    });
    if (!__all_sync(k_warp, is_certain)) return {k_unknown_rival, 0, 0};
    const int lane = least.lane();
    if (lane < 0) return {lane, 0, 0};
    return {__shfl_sync(k_warp, least.at, lane), __shfl_sync(k_warp, least.value, lane),
            __shfl_sync(k_warp, least.doubt, lane)};
  }

 private:
  static constexpr int k_each = RowMemory::k_chosen / 32;

  __device__ double x(int at) const { return memory_.x[chosen_[at]]; }
  __device__ double y(int at) const { return memory_.y[chosen_[at]]; }
  template <class Work>
  __device__ void for_mine(Work&& work) const {
    for (int j = 0; j < k_each; ++j) {
      const int at = 32 * j + static_cast<int>(threadIdx.x % 32);
      if (at < count_) work(at, mine_[j]);
    }
  }

  const RowMemory& memory_;
  std::uint16_t* chosen_;
  WeightedPoint2 here_;
  Wave mine_[k_each];
  int count_ = 0;
};

/// Finds, for a whole warp, all that may matter to the sites of a box, within a margin. False when there are too many.
__device__ inline bool find_near(const WeightedTree& tree, const DeviceBox& around, double margin, RowMemory& memory) {
  const int lane = threadIdx.x % 32;
  int count = 0;
  __syncwarp();  // what an earlier attempt wrote is written
  visit_leaves(
      tree.boxes,
      [&](int level, std::int32_t child) {
        const double reach = margin + tree.heaviest[level][child];
        const double away = square_distance(around, tree.boxes.boxes[level][child]);
        return reach > 0 && away < reach * reach * (1 + k_reach_slack) ? away : -1;
      },
      [&](std::int32_t site) {
        bool is_in = false;
        WeightedPoint2 p{};
        if (site >= 0) {
          p = tree.site(site);
          const double reach = margin + p.weight;
          is_in = reach > 0 && around.square_distance(p.x, p.y) < reach * reach * (1 + k_reach_slack);
        }
        const unsigned those = __ballot_sync(k_warp, is_in);
        const int at = count + __popc(those & ((1u << lane) - 1));
        if (is_in && at < RowMemory::k_near) {
          memory.x[at] = p.x, memory.y[at] = p.y, memory.weight[at] = p.weight;
          memory.rank[at] = site;
        }
        count += __popc(those);
        return count <= RowMemory::k_near;
      });
  if (lane == 0) memory.near_count = count;
  return count <= RowMemory::k_near;
}

/// One cell among the sites near its row.
class RowBuilder {
 public:
  __device__ RowBuilder(const WeightedTree& tree, RowMemory& memory) : tree_(tree), memory_(memory) {}

  /// Builds the cell of a site; false when it takes other means.
  __device__ bool build(std::int32_t rank, double usual_far, const DeviceLists& lists) const {
    const WeightedPoint2 here = tree_.site(rank);
    ChosenWaves waves(memory_, memory_.chosen[threadIdx.x / 32], here);
    const double farthest = memory_.margin + here.weight;  // how far sites are known
    double far = fmin(usual_far, farthest);
    for (int attempt = 0; attempt < 2; ++attempt) {
      if (!waves.choose(rank, far)) return false;
      Found found;
      const bool is_closed = find(waves, found);
      if (is_closed && found.far <= far) return write(rank, found, lists);
      far = is_closed ? fmin(found.far * (1 + k_reach_slack), farthest) : farthest;
    }
    return false;
  }

 private:
  struct Found {
    int neighbor = 0, count = 0;  ///< of the lane
    double far = INFINITY;        ///< twice the distance to the farthest point
  };

  __device__ static bool find(ChosenWaves& waves, Found& found) {
    const int lane = threadIdx.x % 32;
    double lowest = INFINITY;
    const bool is_closed = build_envelope(waves, [&](int at, const WaveCrossing& crossing) {
      if (at == 0 || found.count == k_slots) return false;
      if (lane == found.count) found.neighbor = waves.rank(at);
      ++found.count;
      lowest = fmin(lowest, crossing.height - crossing.doubt);
      return true;
    });
    if (!is_closed || !(lowest > 0)) return false;
    found.far = (1 + k_reach_slack) / lowest;
    return true;
  }

  /// Writes a cell. Leaves those with several sides towards the lowest neighbor: where such a cell begins would have to
  /// be known.
  __device__ static bool write(std::int32_t rank, const Found& found, const DeviceLists& lists) {
    const int lane = threadIdx.x % 32;
    const unsigned key = lane < found.count ? static_cast<unsigned>(found.neighbor) : ~0u;
    const unsigned begins = __ballot_sync(k_warp, key == warp_min(key));
    if (__popc(begins) != 1) return false;
    write_list(lists, rank, found.neighbor, found.count, false, __ffs(static_cast<int>(begins)) - 1);
    return true;
  }

  const WeightedTree& tree_;
  RowMemory& memory_;
};

__global__ void __launch_bounds__(k_row_threads)
    find_weighted_cells(WeightedTree tree, IndexRange boxes, int* taken, DeviceLists lists) {
  __shared__ RowMemory memory;
  const RowBuilder builder(tree, memory);
  const int lane = threadIdx.x % 32, warp = threadIdx.x / 32;
  while (true) {
    __syncthreads();
    if (threadIdx.x == 0) memory.box = boxes.begin + atomicAdd(taken, 1);
    __syncthreads();
    const int box = memory.box;
    if (box >= boxes.end) return;
    const DeviceBox around = tree.boxes.boxes[0][box];
    const std::int32_t begin = 32 * box, end = min(begin + 32, tree.boxes.site_count);
    const double width = around.high[0] - around.low[0], height = around.high[1] - around.low[1];
    const double mean = fmax(sqrt(width * height / (end - begin)), fmax(width, height) / (end - begin));
    constexpr double k_usual = 2.8, k_most = 4.5;  // mean distances: a cell's farthest point, twice
    if (warp == 0) {
      const double lightest = -heaviest_of_warp(lane < end - begin ? -tree.weights[begin + lane] : -INFINITY);
      double far = k_most * mean;
      bool is_found = false;
      for (int attempt = 0; attempt < 4 && !is_found; ++attempt) {
        is_found = find_near(tree, around, far - lightest, memory);
        if (lane == 0) memory.margin = is_found ? far - lightest : -INFINITY;
        far *= 0.6;
      }
      if (lane == 0 && !is_found) memory.near_count = 0;
    }
    __syncthreads();
    for (std::int32_t rank = begin + warp; rank < end; rank += k_row_warps)
      if (!builder.build(rank, k_usual * mean, lists) && lane == 0) lists.far[atomicAdd(lists.far_count, 1)] = rank;
  }
}

}  // namespace
}  // namespace saddleback::voronoi2d
