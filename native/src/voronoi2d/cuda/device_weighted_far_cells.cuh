#pragma once
// Weighted cells that the sites near a row could not tell: those at the border of all sites, or beside a gap. Wound
// among all sites, through the tree of their boxes: no wave of sites in a box rises above that of a disk about it with
// the heaviest weight.

#include "voronoi2d/cuda/device_envelope.cuh"
#include "voronoi2d/cuda/device_far_cells.cuh"

namespace saddleback::voronoi2d {
namespace {

struct FarWaveMemory {
  static constexpr int k_most = 256;
  std::int32_t rank[k_most];  ///< of those that rise in turn; k_nobody for the infinitely far
  double turn[k_most];        ///< where, from the start
  double doubt[k_most];
};

/// All sites by rank, as one of them sees them, and the infinitely far: candidates for the envelope.
class AllWaves {
 public:
  static constexpr int k_far = -3;

  __device__ AllWaves(const WeightedTree& tree, std::int32_t own) : tree_(tree), own_(own), here_(tree.site(own)) {}

  __device__ Wave wave(int at) const { return at == k_far ? Wave{0, 0, 0, 0, 0} : careful_wave(here_, tree_.site(at)); }

  __device__ int highest(const Direction& u) const {
    Least least;
    if (threadIdx.x % 32 == 0) least.take(0, 0, k_far);
    float bound = 0;
    const bool is_done = visit_sites(
        [&](const Wave& disk) { return height_at(disk, u) + height_doubt(disk, u) >= -static_cast<double>(bound); },
        [&](std::int32_t rank, const Wave& wave) {
          if (rank >= 0) least.take(-height_at(wave, u), height_doubt(wave, u), rank);
          bound = least.warp_bound();
          return true;
        });
    const int lane = is_done ? least.lane() : k_unknown_rival;
    return lane < 0 ? k_unknown_rival : __shfl_sync(k_warp, least.at, lane);
  }

  __device__ Rise next(int present_at, const Wave& present, const Direction& from) const {
    Least least;
    bool is_certain = true;
    if (threadIdx.x % 32 == 0 && present_at != k_far) is_certain = take_rise(present, from, wave(k_far), k_far, least);
    float bound = least.warp_bound();
    const double height = height_at(present, from), doubt = height_doubt(present, from);
    const bool is_done = visit_sites(
        [&](const Wave& disk) {
          if (height_at(disk, from) + height_doubt(disk, from) >= height - doubt) return true;
          const WaveCrossing crossing = wave_crossing(present, disk);
          if (!(crossing.blur < INFINITY)) return !are_apart(present, disk);
          return turned(from, crossing.x, crossing.y) - turn_doubt(from.blur, crossing.blur) <= bound;
        },
        [&](std::int32_t rank, const Wave& wave) {
          if (rank >= 0 && rank != present_at) is_certain = take_rise(present, from, wave, rank, least) && is_certain;
          bound = least.warp_bound();
          return true;
        });
    if (!is_done || !__all_sync(k_warp, is_certain)) return {k_unknown_rival, 0, 0};
    const int lane = least.lane();
    if (lane < 0) return {lane, 0, 0};
    return {__shfl_sync(k_warp, least.at, lane), __shfl_sync(k_warp, least.value, lane),
            __shfl_sync(k_warp, least.doubt, lane)};
  }

 private:
  static constexpr int k_most_visits = 20000;  ///< of boxes

  __device__ static double height_at(const Wave& wave, const Direction& u) {
    return wave.x * u.x + wave.y * u.y + wave.z;
  }
  __device__ static double height_doubt(const Wave& wave, const Direction& u) {
    return 2 * (wave.doubt + wave.size * (u.blur + 0x1p-50));
  }

  /// Calls visit(rank or -1, wave) for those in the boxes whose disks `may_matter`. False when visit() was, or there
  /// are too many.
  template <class MayMatter, class Visit>
  __device__ bool visit_sites(MayMatter&& may_matter, Visit&& visit) const {
    int visits = 0;
    bool goes_on = true;
    visit_leaves(
        tree_.boxes,
        [&](int level, std::int32_t child) {
          const DeviceBox& box = tree_.boxes.boxes[level][child];
          const double half_x = 0.5 * (box.high[0] - box.low[0]), half_y = 0.5 * (box.high[1] - box.low[1]);
          const double x = box.low[0] + half_x, y = box.low[1] + half_y, heaviest = tree_.heaviest[level][child];
          constexpr double k_larger = 1 + 0x1p-40;
          const double radius = k_larger * sqrt(half_x * half_x + half_y * half_y) + 0x1p-50 * (fabs(x) + fabs(y));
          const double weight = heaviest + radius;
          const Wave disk = wave_at(here_, x, y, weight - here_.weight, 0x1p-51 * (fabs(weight) + fabs(here_.weight)));
          const bool enters = !(disk.doubt < INFINITY) || may_matter(disk);
          return enters ? box.square_distance(here_.x, here_.y) : -1;
        },
        [&](std::int32_t site) {
          const std::int32_t rank = site == own_ ? -1 : site;
          goes_on = visit(rank, rank >= 0 ? wave(rank) : Wave{}) && ++visits < k_most_visits;
          return goes_on;
        });
    return goes_on;
  }

  const WeightedTree& tree_;
  std::int32_t own_;
  WeightedPoint2 here_;
};

class FarEnvelopeBuilder {
 public:
  __device__ FarEnvelopeBuilder(const WeightedTree& tree, FarWaveMemory& memory) : tree_(tree), memory_(memory) {}

  __device__ bool build(std::int32_t rank, const DeviceLists& lists) {
    const AllWaves all(tree_, rank);
    count_ = 0;
    const int lane = threadIdx.x % 32;
    const bool is_found = build_envelope(all, [&](int at, const WaveCrossing& crossing) {
      if (count_ == FarWaveMemory::k_most) return false;
      if (lane == 0) {
        memory_.rank[count_] = at == AllWaves::k_far ? k_nobody : at;
        memory_.turn[count_] = turned(k_start, crossing.x, crossing.y);
        memory_.doubt[count_] = turn_doubt(k_start.blur, crossing.blur);
      }
      ++count_;
      return true;
    });
    __syncwarp();
    if (!is_found) return false;
    const int first = first_side(all);
    return first >= 0 && write(rank, first, lists);
  }

 private:
  __device__ int after(int arc) const { return arc + 1 == count_ ? 0 : arc + 1; }

  /// The first side towards the lowest neighbor, of several from the direction away from it on.
  __device__ int first_side(const AllWaves& all) const {
    unsigned lowest = ~0u;
    for (int k = 0; k < count_; ++k) lowest = min(lowest, static_cast<unsigned>(memory_.rank[k]));  // nobody: ~0
    int found = -1, times = 0;
    for (int k = 0; k < count_; ++k) {
      if (static_cast<unsigned>(memory_.rank[k]) != lowest) continue;
      found = k;
      ++times;
    }
    if (lowest == ~0u || times <= 1) return lowest == ~0u ? -1 : found;
    const Wave wave = all.wave(static_cast<std::int32_t>(lowest));
    const double length = sqrt(wave.x * wave.x + wave.y * wave.y);
    const double turn = turned(k_start, -wave.x / length, -wave.y / length);
    const double doubt = turn_doubt(k_start.blur, wave.doubt / length);
    int opposite = count_ - 1;  // the arc there
    for (int k = 0; k < count_; ++k) {
      if (!(fabs(memory_.turn[k] - turn) > memory_.doubt[k] + doubt)) return -1;
      if (memory_.turn[k] < turn) opposite = k;
    }
    for (int k = after(opposite); k != opposite; k = after(k))
      if (static_cast<unsigned>(memory_.rank[k]) == lowest) return k;
    return -1;
  }

  __device__ bool write(std::int32_t rank, int first, const DeviceLists& lists) const {
    const int lane = threadIdx.x % 32;
    int sides = 0;
    for (int k = 0; k < count_; ++k) sides += memory_.rank[k] != k_nobody;
    std::int32_t* const to = place_for_list(lists, rank, sides);
    if (!to) return false;
    if (lane != 0) return true;
    int place = 0, arc = first;
    for (int step = 0; step < count_; ++step, arc = after(arc)) {
      if (memory_.rank[arc] == k_nobody) continue;
      to[place++] = memory_.rank[after(arc)] == k_nobody ? open_side(memory_.rank[arc]) : memory_.rank[arc];
    }
    lists.counts[rank] = sides;
    lists.is_open[rank] = false;  // the sides say where
    return true;
  }

  const WeightedTree& tree_;
  FarWaveMemory& memory_;
  int count_ = 0;
};

__global__ void __launch_bounds__(k_far_threads)
    find_far_weighted_cells(WeightedTree tree, FarCells far, DeviceLists lists) {
  __shared__ FarWaveMemory memory[k_far_threads / 32];
  FarEnvelopeBuilder builder(tree, memory[threadIdx.x / 32]);
  for (std::int32_t rank = far.take(); rank >= 0; rank = far.take()) {
    if (!builder.build(rank, lists) && threadIdx.x % 32 == 0) lists.far[atomicAdd(far.failures, 1)] = rank;
    __syncwarp();
  }
}

}  // namespace
}  // namespace saddleback::voronoi2d
