#pragma once
// A tile's sites and those about it, in a grid in a block's memory.

#include "voronoi2d/cuda/device_boxes.cuh"
#include "voronoi2d/cuda/device_tiles.cuh"

namespace saddleback::voronoi2d {
namespace {

constexpr int k_tile_threads = 128, k_tile_warps = k_tile_threads / 32;
constexpr int k_seen_sites = 512, k_grid_cells = 640, k_frontier = 128;
constexpr double k_sites_per_grid_cell = 1.6;

struct TileMemory {
  double2 at[k_seen_sites];  ///< by grid cell
  std::int32_t rank[k_seen_sites];
  std::int32_t found[k_seen_sites];  ///< ranks in any order
  std::uint16_t cell[k_seen_sites];
  std::uint16_t own[k_tile_sites];
  std::uint16_t begins[k_grid_cells + 1];
  std::int32_t frontier[2][k_frontier];
  int frontier_count[2], found_count, own_count, is_lattice;
  unsigned failing[k_tile_sites / 32];  ///< own sites, by rank in the tile, whose cells take other sites
  int grid_counts[k_grid_cells + 1];
};

/// A tile's sites and those about it, in a grid.
class TileSites {
 public:
  __device__ TileSites(TileMemory& memory, const DeviceTree& tree) : memory_(memory), tree_(tree) {}

  /// Gathers, with the sites beside the tile as far as `margin`, in mean distances, or less far where they are many. By
  /// all threads of the block. False when there are too many.
  __device__ bool gather(std::int32_t begin, std::int32_t end, double margin) {
    begin_ = begin;
    end_ = end;
    const DeviceBox box = own_box();
    const double width = box.high[0] - box.low[0], height = box.high[1] - box.low[1];
    const double count = end - begin;
    double beside = margin * fmax(sqrt(width * height / count), fmax(width, height) / count);
    constexpr int k_attempts = 4;
    for (int attempt = 0; attempt < k_attempts; ++attempt, beside *= 0.4) {
      box_ = {{box.low[0] - beside, box.low[1] - beside}, {box.high[0] + beside, box.high[1] + beside}};
      if (!find_in_box()) continue;
      know_outside();
      sort_into_grid();
      return true;
    }
    return false;
  }

  /// Own sites whose cells are to be found among more sites. By a warp.
  __device__ void clear_failing() {
    if (threadIdx.x < k_tile_sites / 32) memory_.failing[threadIdx.x] = 0;
  }
  __device__ void note_failing(std::int32_t rank) {
    const auto i = static_cast<unsigned>(rank - begin_);
    if (threadIdx.x % 32 == 0) atomicOr(&memory_.failing[i / 32], 1u << i % 32);
  }
  __device__ bool is_failing(std::int32_t rank) const {
    const auto i = static_cast<unsigned>(rank - begin_);
    return memory_.failing[i / 32] >> i % 32 & 1;
  }
  __device__ bool has_failing() const {
    unsigned any = 0;
    for (int i = 0; i < k_tile_sites / 32; ++i) any |= memory_.failing[i];
    return any != 0;
  }

  __device__ const TileMemory& memory() const { return memory_; }
  __device__ const DeviceBox& box() const { return box_; }
  __device__ const DeviceBox& known() const { return known_; }  ///< all sites in it are known; infinite beyond the last
  __device__ double grid_size() const { return grid_; }
  __device__ int width() const { return width_; }
  __device__ int height() const { return height_; }
  __device__ int column(double x) const { return min(static_cast<int>((x - box_.low[0]) * inverse_grid_), width_ - 1); }
  __device__ int row(double y) const { return min(static_cast<int>((y - box_.low[1]) * inverse_grid_), height_ - 1); }

 private:
  __device__ DeviceBox own_box() const {
    DeviceBox box{{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
    for (std::int32_t i = begin_ + static_cast<int>(threadIdx.x % 32); i < end_; i += 32) {
      const double2 p = tree_.sites[i];
      box.low[0] = fmin(box.low[0], p.x);
      box.low[1] = fmin(box.low[1], p.y);
      box.high[0] = fmax(box.high[0], p.x);
      box.high[1] = fmax(box.high[1], p.y);
    }
    return joined(box);
  }

  __device__ void append(bool is_in, std::int32_t value, std::int32_t* list, int& count, int room) const {
    const unsigned those = __ballot_sync(k_warp, is_in);
    if (those == 0) return;
    const int lane = threadIdx.x % 32;
    int first = 0;
    if (lane == 0) first = atomicAdd(&count, __popc(those));
    const int at = __shfl_sync(k_warp, first, 0) + __popc(those & ((1u << lane) - 1));
    if (is_in && at < room) list[at] = value;
  }

  __device__ bool find_in_box() {
    const int lane = threadIdx.x % 32, warp = threadIdx.x / 32;
    __syncthreads();
    if (threadIdx.x == 0) {
      memory_.found_count = memory_.own_count = memory_.frontier_count[0] = memory_.frontier_count[1] = 0;
      memory_.is_lattice = 1;
    }
    __syncthreads();
    int from = 0;
    if (warp == 0) {
      const int top = tree_.levels - 1;
      const bool is_in = lane < tree_.counts[top] && tree_.boxes[top][lane].meets(box_);
      append(is_in, lane, memory_.frontier[0], memory_.frontier_count[0], k_frontier);
    }
    __syncthreads();
    for (int level = tree_.levels - 2; level >= 0; --level, from ^= 1) {
      const int count = memory_.frontier_count[from];
      if (count > k_frontier) return false;
      for (int i = warp; i < count; i += k_tile_warps) {
        const std::int32_t child = memory_.frontier[from][i] * 32 + lane;
        const bool is_in = child < tree_.counts[level] && tree_.boxes[level][child].meets(box_);
        append(is_in, child, memory_.frontier[from ^ 1], memory_.frontier_count[from ^ 1], k_frontier);
      }
      __syncthreads();
      if (threadIdx.x == 0) memory_.frontier_count[from] = 0;
      __syncthreads();
    }
    const int count = memory_.frontier_count[from];
    if (count > k_frontier) return false;
    for (int i = warp; i < count; i += k_tile_warps) {
      const std::int32_t rank = memory_.frontier[from][i] * 32 + lane;
      bool is_in = rank < tree_.site_count;
      if (is_in) {
        const double2 p = tree_.sites[rank];
        is_in = box_.contains(p.x, p.y);
      }
      append(is_in, rank, memory_.found, memory_.found_count, k_seen_sites);
    }
    __syncthreads();
    return memory_.found_count <= k_seen_sites;
  }

  /// Notes that nothing is farther out where the box ends outside of all sites.
  __device__ void know_outside() {
    const int top = tree_.levels - 1, lane = threadIdx.x % 32;
    const DeviceBox all = joined(tree_.boxes[top][min(lane, tree_.counts[top] - 1)]);
    for (int k = 0; k < 2; ++k) {
      known_.low[k] = box_.low[k] <= all.low[k] ? -INFINITY : box_.low[k];
      known_.high[k] = box_.high[k] >= all.high[k] ? INFINITY : box_.high[k];
    }
  }

  __device__ void sort_into_grid() {
    const int count = memory_.found_count;
    const double width = box_.high[0] - box_.low[0], height = box_.high[1] - box_.low[1];
    constexpr double k_longest = 127;
    grid_ = fmax(sqrt(width * height * k_sites_per_grid_cell / count), fmax(width, height) / k_longest);
    if (!(grid_ > 0)) grid_ = 1;
    inverse_grid_ = 1 / grid_;
    width_ = static_cast<int>(width * inverse_grid_) + 1;
    height_ = static_cast<int>(height * inverse_grid_) + 1;
    const int cells = width_ * height_;
    for (int i = threadIdx.x; i <= cells; i += k_tile_threads) memory_.grid_counts[i] = 0;
    __syncthreads();
    const double2 origin = tree_.sites[begin_];
    const double unit = exp2(static_cast<double>(ilogb(fmax(width, height)) - 10)), per_unit = 1 / unit;
    bool is_lattice = true;
    for (int i = threadIdx.x; i < count; i += k_tile_threads) {
      const double2 p = tree_.sites[memory_.found[i]];
      const int cell = row(p.y) * width_ + column(p.x);
      memory_.cell[i] = static_cast<std::uint16_t>(cell);
      atomicAdd(&memory_.grid_counts[cell + 1], 1);
      const double dx = p.x - origin.x, dy = p.y - origin.y;
      is_lattice = is_lattice && origin.x + dx == p.x && origin.y + dy == p.y && rint(dx * per_unit) == dx * per_unit &&
                   rint(dy * per_unit) == dy * per_unit;
    }
    if (!is_lattice) memory_.is_lattice = 0;
    __syncthreads();
    if (threadIdx.x < 32) {  // sums of the counts
      int before = 0;
      for (int first = 0; first <= cells; first += 32) {
        const int i = first + static_cast<int>(threadIdx.x);
        int sum = i <= cells ? memory_.grid_counts[i] : 0;
        for (int step = 1; step < 32; step *= 2) {
          const int other = __shfl_up_sync(k_warp, sum, step);
          if (static_cast<int>(threadIdx.x) >= step) sum += other;
        }
        sum += before;
        if (i <= cells) {
          memory_.begins[i] = static_cast<std::uint16_t>(sum);
          memory_.grid_counts[i] = sum;
        }
        before = __shfl_sync(k_warp, sum, 31);
      }
    }
    __syncthreads();
    for (int i = threadIdx.x; i < count; i += k_tile_threads) {
      const std::int32_t rank = memory_.found[i];
      const int to = atomicAdd(&memory_.grid_counts[memory_.cell[i]], 1);
      memory_.at[to] = tree_.sites[rank];
      memory_.rank[to] = rank;
      if (rank >= begin_ && rank < end_) memory_.own[atomicAdd(&memory_.own_count, 1)] = static_cast<std::uint16_t>(to);
    }
    __syncthreads();
  }

  TileMemory& memory_;
  const DeviceTree& tree_;
  DeviceBox box_{}, known_{};
  double grid_ = 1, inverse_grid_ = 1;
  int width_ = 1, height_ = 1;
  std::int32_t begin_ = 0, end_ = 0;
};

}  // namespace
}  // namespace saddleback::voronoi2d
