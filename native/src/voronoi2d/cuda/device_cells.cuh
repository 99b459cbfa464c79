#pragma once
// The cells of a tile's sites, a warp each. A circle through the site and a neighbor, to the left of both, grows until
// it touches the next site: that is the next neighbor, and so on around the cell. All lanes try a few sites each. One
// circle per tile that sweeps the sites from near to far, as on the processor, would leave most lanes idle.
//
// Single precision tells nearly all of the sites that come too late; double precision, and exact arithmetic where the
// sites lie on a lattice, decides between the others. What cannot be decided here, or not among the tile's sites, is
// left to `device_far_cells.cuh`.

#include "support/cuda/index_range.cuh"
#include "voronoi2d/cuda/device_plane_signs.cuh"
#include "voronoi2d/cuda/device_tile_sites.cuh"

namespace saddleback::voronoi2d {
namespace {

// The distances about a tile up to which sites are looked at, in mean distances: at first, and for cells that need
// more.
constexpr double k_margin = 2.75, k_wide_margin = 4.25;
constexpr int k_slots = 16;  ///< room for a cell's neighbors; the lists of larger ones are in the pool

/// Neighbors as they are found, by rank.
struct DeviceLists {
  std::int32_t* slots;   ///< k_slots a cell; the first tells where in the pool a longer list begins
  std::int32_t* counts;  ///< by rank
  std::uint8_t* is_open;
  std::int32_t* pool;
  unsigned* pool_taken;
  unsigned pool_room;
  std::int32_t* far;  ///< ranks of cells that were not found yet
  int* far_count;
};

__device__ inline unsigned ordered(float value) {
  const unsigned bits = __float_as_uint(value);
  return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}
__device__ inline float disordered(unsigned bits) {
  return __uint_as_float(bits & 0x80000000u ? bits & 0x7fffffffu : ~bits);
}

/// Writes a list that lane k holds neighbor k of, from `first` on around.
__device__ inline void write_list(const DeviceLists& lists, std::int32_t rank, int neighbor, int count, bool is_open,
                                  int first) {
  const int lane = threadIdx.x % 32;
  if (lane < count) {
    const int to = lane >= first ? lane - first : lane - first + count;
    lists.slots[static_cast<std::int64_t>(rank) * k_slots + to] = neighbor;
  }
  if (lane == 0) {
    lists.counts[rank] = count;
    lists.is_open[rank] = is_open;
  }
}

/// Returns to a whole warp where a cell's list of any length goes; null when there is no room.
__device__ inline std::int32_t* place_for_list(const DeviceLists& lists, std::int32_t rank, int count) {
  std::int32_t* const slots = lists.slots + static_cast<std::int64_t>(rank) * k_slots;
  if (count <= k_slots) return slots;
  const int lane = threadIdx.x % 32;
  unsigned begin = 0;
  if (lane == 0) begin = atomicAdd(lists.pool_taken, static_cast<unsigned>(count));
  begin = __shfl_sync(k_warp, begin, 0);
  if (begin + static_cast<unsigned>(count) > lists.pool_room) return nullptr;
  if (lane == 0) *slots = static_cast<std::int32_t>(begin);
  return lists.pool + begin;
}

/// Holds how far along the line of centers the circle through the site and n touches another site: surely between two
/// bounds; infinite for a site to the right.
struct Touch {
  float low, high;
  bool is_doubtful;  ///< neither surely left nor surely out of the way
};

/// A site seen from the one whose cell is built, in single precision.
struct Near {
  float x, y, square;
};
__device__ inline Near near_of(double2 p, double2 site, double scale) {
  Near result;
  result.x = static_cast<float>((p.x - site.x) * scale);
  result.y = static_cast<float>((p.y - site.y) * scale);
  result.square = __fmaf_rn(result.x, result.x, result.y * result.y);
  return result;
}

__device__ inline Touch touch(const Near& n, const Near& p) {
  constexpr float k_error = 6e-7f, k_side = 4e-6f, k_beside = 1e-5f;  // ten and more roundings
  const float cross = __fmaf_rn(n.x, p.y, -n.y * p.x);
  const float along = __fmaf_rn(-n.y, p.y, __fmaf_rn(-n.x, p.x, p.square));
  const float lengths = __fmaf_rn(0.5f, p.square, 0.5f * n.square);  // not less than the product
  const float side = k_side * lengths, sum = p.square + lengths;
  const float inverse = __fdividef(1.0f, cross), t = along * inverse;
  const float error = k_error * inverse * __fmaf_rn(lengths, fabsf(t), sum);
  const bool is_left = cross > side;
  return {is_left ? t - error : INFINITY, is_left ? t + error : INFINITY,
          fabsf(cross) <= side && along <= k_beside * sum};  // on the way to n, or beside it
}

/// One warp's cell.
class CellBuilder {
 public:
  __device__ explicit CellBuilder(const TileSites& tile) : tile_(tile), memory_(tile.memory()) {}

  /// Begins with the sites that were gathered.
  __device__ void begin() {
    scale_ = __longlong_as_double(static_cast<long long>(1023 - ilogb(tile_.grid_size())) << 52);
  }

  /// Builds the cell of a site; false when it takes other means.
  __device__ bool build(int own, const DeviceLists& lists) {
    own_ = own;
    site_ = memory_.at[own];
    return build_among<false>(lists) || build_among<true>(lists);
  }
  /// Does the same for cells that are not to be found among the nearest sites.
  __device__ bool build_wide(int own, const DeviceLists& lists) {
    own_ = own;
    site_ = memory_.at[own];
    return build_among<true>(lists);
  }

 private:
  static constexpr int k_each = 2, k_reach = 2;

  template <bool All>
  __device__ bool build_among(const DeviceLists& lists) {
    if (All) {
      const DeviceBox& known = tile_.known();
      set_reach(known.low[0], known.high[0], known.low[1], known.high[1]);
    } else if (!load_candidates()) {
      return false;
    }
    const int lane = threadIdx.x % 32;
    const int first = nearest<All>();
    if (first < 0) return false;
    int neighbor = 0, count = 0;
    Near mine{};
    for (int at = first;;) {
      if (lane == count) neighbor = memory_.rank[at], mine = n_;
      if (++count > k_slots) return false;
      at = next_after<All>(at);
      if (at < 0) return false;
      if (at == first) break;
    }
    if (!are_covered(mine, count)) return false;
    const unsigned key = lane < count ? static_cast<unsigned>(neighbor) : ~0u;
    const unsigned lowest = warp_min(key);
    const int begin = __ffs(static_cast<int>(__ballot_sync(k_warp, key == lowest))) - 1;
    write_list(lists, memory_.rank[own_], neighbor, count, false, begin);
    return true;
  }

  __device__ void set_reach(double left, double right, double bottom, double top) {
    to_left_ = static_cast<float>((site_.x - left) * scale_);
    to_right_ = static_cast<float>((right - site_.x) * scale_);
    to_bottom_ = static_cast<float>((site_.y - bottom) * scale_);
    to_top_ = static_cast<float>((top - site_.y) * scale_);
  }

  /// The sites of five rows and columns of the grid, two a lane.
  __device__ bool load_candidates() {
    const int lane = threadIdx.x % 32, width = tile_.width();
    const int column = tile_.column(site_.x), row = tile_.row(site_.y);
    const int left = max(column - k_reach, 0), right = min(column + k_reach, width - 1);
    const int bottom = max(row - k_reach, 0), top = min(row + k_reach, tile_.height() - 1);
    int begin = 0, length = 0;
    if (lane <= top - bottom) {
      const int base = (bottom + lane) * width;
      begin = memory_.begins[base + left];
      length = memory_.begins[base + right + 1] - begin;
    }
    for (int j = 0; j < k_each; ++j) at_[j] = -1;
    int total = 0;
    for (int r = 0; r <= 2 * k_reach; ++r) {
      const int row_begin = __shfl_sync(k_warp, begin, r), row_length = __shfl_sync(k_warp, length, r);
      for (int j = 0; j < k_each; ++j) {
        const int k = lane + 32 * j - total;
        if (k >= 0 && k < row_length) at_[j] = row_begin + k;
      }
      total += row_length;
    }
    if (total > 32 * k_each) return false;
    const DeviceBox &box = tile_.box(), &known = tile_.known();
    const double grid = tile_.grid_size();
    set_reach(left == 0 ? known.low[0] : box.low[0] + left * grid,
              right + 1 == width ? known.high[0] : box.low[0] + (right + 1) * grid,
              bottom == 0 ? known.low[1] : box.low[1] + bottom * grid,
              top + 1 == tile_.height() ? known.high[1] : box.low[1] + (top + 1) * grid);
    for (int j = 0; j < k_each; ++j) {
      if (at_[j] == own_) at_[j] = -1;
      near_[j] = {0, 0, INFINITY};
      if (at_[j] >= 0) near_[j] = near_of(memory_.at[at_[j]], site_, scale_);
    }
    return true;
  }

  /// Calls work(site in the tile, how it is seen) for the lane's share.
  template <bool All, class Work>
  __device__ void for_candidates(Work&& work) const {
    if (All) {
      for (int at = static_cast<int>(threadIdx.x % 32); at < memory_.found_count; at += 32)
        if (at != own_) work(at, near_of(memory_.at[at], site_, scale_));
    } else {
      for (int j = 0; j < k_each; ++j) work(at_[j], near_[j]);
    }
  }

  /// The nearest site, to n; of about equally near ones any, since each has a side of the cell unless they are side by
  /// side.
  template <bool All>
  __device__ int nearest() {
    constexpr float k_smallest = 1e-12f;
    int mine_at = -1;
    Near mine{0, 0, INFINITY};
    for_candidates<All>([&](int at, const Near& p) {
      if (p.square < mine.square) mine = p, mine_at = at;
    });
    const float least = __uint_as_float(warp_min(__float_as_uint(mine.square)));
    if (!(least > k_smallest && least < INFINITY)) return -1;
    const int chosen = take(mine_at, mine, __ballot_sync(k_warp, mine.square == least));
    bool is_rivalled = false;
    for_candidates<All>([&](int at, const Near& p) {
      is_rivalled |= p.square <= least * 1.00001f && at != chosen && p.x * n_.x + p.y * n_.y > 0.99f * least;
    });
    return __any_sync(k_warp, is_rivalled) ? -1 : chosen;
  }

  /// Gives n what the first of some lanes has.
  __device__ int take(int at, const Near& near, unsigned lanes) {
    const int lane = __ffs(static_cast<int>(lanes)) - 1;
    n_ = {__shfl_sync(k_warp, near.x, lane), __shfl_sync(k_warp, near.y, lane), __shfl_sync(k_warp, near.square, lane)};
    return __shfl_sync(k_warp, at, lane);
  }

  /// Returns the neighbor after n, counter-clockwise, to n; -1 when it cannot be decided.
  template <bool All>
  __device__ int next_after(int n) {
    int mine_at = -1;
    Near mine{};
    float low = INFINITY, high = INFINITY, other_low = INFINITY;  // of the lane's first, and of its others
    bool is_doubtful = false;
    for_candidates<All>([&](int at, const Near& p) {
      const Touch found = touch(n_, p);
      is_doubtful |= found.is_doubtful && at != n && at >= 0;
      const bool is_first = found.high < high;
      other_low = fminf(other_low, is_first ? low : found.low);
      if (is_first) mine = p, mine_at = at, low = found.low, high = found.high;
    });
    const float bound = disordered(warp_min(ordered(high)));
    const unsigned near = __ballot_sync(k_warp, low <= bound);
    const unsigned troubles = __ballot_sync(k_warp, is_doubtful || other_low <= bound);
    if (!(bound < INFINITY)) return -1;
    if (__popc(near) == 1 && troubles == 0) return take(mine_at, mine, near);
    if (All || __any_sync(k_warp, is_doubtful)) return -1;
    return decide(n, bound);
  }

  /// The first of several that the circle touches, or the last around of those that it touches at once.
  __device__ int decide(int n, float bound) {
    int best = -1;
    double best_x = 0, best_y = 0;
    const double n_x = memory_.at[n].x - site_.x, n_y = memory_.at[n].y - site_.y;
    for (int j = 0; j < k_each; ++j) {
      for (unsigned left = __ballot_sync(k_warp, touch(n_, near_[j]).low <= bound); left; left &= left - 1) {
        const int at = __shfl_sync(k_warp, at_[j], __ffs(static_cast<int>(left)) - 1);
        const double dx = memory_.at[at].x - site_.x, dy = memory_.at[at].y - site_.y;
        bool is_better = best < 0;
        if (best >= 0) {
          bool is_known;
          const int sign = circle_sign(n_x, n_y, best_x, best_y, dx, dy, memory_.is_lattice, is_known);
          if (!is_known) return -1;
          is_better = sign < 0;
          if (sign == 0) {
            const double cross = best_x * dy - best_y * dx;
            if (fabs(cross) < 1e-9 * (fabs(best_x * dy) + fabs(best_y * dx))) return -1;
            is_better = cross > 0;
          }
        }
        if (is_better) best = at, best_x = dx, best_y = dy;
      }
    }
    n_ = near_of(memory_.at[best], site_, scale_);
    return best;
  }

  /// Tells whether all sites in the circles through the site, a lane's neighbor and the next lane's were seen.
  __device__ bool are_covered(const Near& a, int count) const {
    const int lane = threadIdx.x % 32, next = lane + 1 < count ? lane + 1 : 0;
    const float b_x = __shfl_sync(k_warp, a.x, next), b_y = __shfl_sync(k_warp, a.y, next),
                b_square = __shfl_sync(k_warp, a.square, next);
    const float cross = a.x * b_y - a.y * b_x, half = __fdividef(0.5f, cross);
    const float x = (b_y * a.square - a.y * b_square) * half, y = (a.x * b_square - b_x * a.square) * half;
    constexpr float k_flat = 1e-3f, k_larger = 1.003f;
    const float radius = k_larger * sqrtf(x * x + y * y);
    const bool is_covered = cross > 0 && cross * cross > k_flat * k_flat * a.square * b_square &&
                            x - radius >= -to_left_ && x + radius <= to_right_ && y - radius >= -to_bottom_ &&
                            y + radius <= to_top_;
    return __all_sync(k_warp, is_covered || lane >= count);
  }

  const TileSites& tile_;
  const TileMemory& memory_;
  double scale_ = 1;  ///< a power of two that makes the grid's size about 1
  double2 site_{};
  int own_ = 0;
  float to_left_ = 0, to_right_ = 0, to_bottom_ = 0, to_top_ = 0;
  Near near_[k_each], n_{};
  int at_[k_each];
};

/// Tiles from `first` on, before `last`.
struct TileRange {
  const std::int32_t *begins, *count;
  int* taken;
  std::int32_t first, last;
  IndexRange sites;  ///< of all launches
  int most_far;      ///< all are left where there are more cells to find by other means, and many of those so far
  int* are_left;     ///< whether they are

  __device__ std::int32_t end() const { return min(*count, last); }
  /// The next tile; when there is none the end, or what lies behind it.
  __device__ std::int32_t take(const int* far_count) const {
    const std::int32_t tile = first + atomicAdd(taken, 1);
    judge(*static_cast<const volatile int*>(far_count), tile);
    return has_left() ? last : tile;
  }
  __device__ bool has_left() const { return *static_cast<volatile int*>(are_left); }
  /// Judges after so many other cells.
  __device__ void judge(int far) const { judge(far, first + *static_cast<volatile int*>(taken)); }

 private:
  __device__ void judge(int far, std::int32_t next) const {
    if (far <= most_far) return;
    constexpr int k_many = 4;  // of as many one
    const std::int32_t done = (next < *count ? begins[next] : sites.end) - sites.begin;
    if (far > done / k_many) *are_left = 1;
  }
};

__global__ void __launch_bounds__(k_tile_threads)
    find_cells_of_tiles(DeviceTree tree, TileRange tiles, DeviceLists lists) {
  extern __shared__ __align__(16) char bytes[];
  TileMemory& memory = *reinterpret_cast<TileMemory*>(bytes);
  __shared__ int tile;
  const int lane = threadIdx.x % 32, warp = threadIdx.x / 32, count = *tiles.count;
  const auto leave = [&](std::int32_t rank) {
    if (lane != 0) return;
    const int far = atomicAdd(lists.far_count, 1);
    lists.far[far] = rank;
    if (far % 256 == 0) tiles.judge(far);  // often enough
  };
  while (true) {
    __syncthreads();
    if (threadIdx.x == 0) tile = tiles.take(lists.far_count);
    __syncthreads();
    if (tile >= tiles.end()) return;
    const std::int32_t begin = tiles.begins[tile], end = tile + 1 < count ? tiles.begins[tile + 1] : tiles.sites.end;
    TileSites sites(memory, tree);
    CellBuilder builder(sites);
    sites.clear_failing();
    if (!sites.gather(begin, end, k_margin)) {
      for (std::int32_t rank = begin + warp; rank < end; rank += k_tile_warps) leave(rank);
      continue;
    }
    builder.begin();
    for (int i = warp; i < memory.own_count; i += k_tile_warps)
      if (!builder.build(memory.own[i], lists)) sites.note_failing(memory.rank[memory.own[i]]);
    __syncthreads();
    if (!sites.has_failing()) continue;
    // These are tried once more, among as many sites as there is room for.
    const bool is_wide = sites.gather(begin, end, k_wide_margin);
    builder.begin();
    for (int i = warp; is_wide && i < memory.own_count; i += k_tile_warps) {
      const std::int32_t rank = memory.rank[memory.own[i]];
      if (!sites.is_failing(rank) || builder.build_wide(memory.own[i], lists)) continue;
      leave(rank);
      if (__any_sync(k_warp, tiles.has_left())) break;
    }
    for (std::int32_t rank = begin + warp; !is_wide && rank < end; rank += k_tile_warps)
      if (sites.is_failing(rank)) leave(rank);
  }
}

}  // namespace
}  // namespace saddleback::voronoi2d
