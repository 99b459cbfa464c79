#pragma once
// The cells that a tile could not tell: those at the border of all sites, beside a gap, or with sites too many or too
// close to a circle. Wound as in `device_cells.cuh`, but among all sites, through the tree of their boxes, and decided
// in double precision or exactly.

#include "voronoi2d/cuda/device_cells.cuh"

namespace saddleback::voronoi2d {
namespace {

struct FarMemory {
  static constexpr int k_most = 192;
  std::int32_t ahead[k_most], behind[k_most];  ///< neighbors from the nearest on, one way and the other
};

class FarCellBuilder {
 public:
  __device__ FarCellBuilder(const DeviceTree& tree, FarMemory& memory) : tree_(tree), memory_(memory) {}

  __device__ bool build(std::int32_t rank, const DeviceLists& lists) {
    rank_ = rank;
    fails_ = false;
    site_ = point(rank);
    const std::int32_t first = nearest();
    if (first < 0) return false;
    int ahead = 0, behind = 0;
    bool is_open = false;
    memory_.ahead[ahead++] = first;
    turn_ = 1;
    for (std::int32_t at = first;;) {
      at = next_after(at);
      if (fails_ || ahead == FarMemory::k_most) return false;
      is_open = at < 0;
      if (is_open || at == first) break;
      memory_.ahead[ahead++] = at;
      __syncwarp();
    }
    if (is_open) {
      turn_ = -1;
      for (std::int32_t at = first;;) {
        at = next_after(at);
        if (fails_ || behind == FarMemory::k_most) return false;
        if (at < 0) break;
        memory_.behind[behind++] = at;
        __syncwarp();
      }
    }
    __syncwarp();
    return write(ahead, behind, is_open, lists);
  }

 private:
  static constexpr int k_most_visits = 20000;  ///< of boxes for one neighbor

  __device__ Point2 point(std::int32_t rank) const {
    const double2 p = tree_.sites[rank];
    return {p.x, p.y};
  }

  /// Visits the boxes that `may_hold` does not rule out, those with the least order(box, square of its distance) first,
  /// and calls visit(rank of the lane's site, or -1, where it is) for the sites in them; it returns whether `may_hold`
  /// holds for fewer now, or the order matters.
  template <class MayHold, class Order, class Visit>
  __device__ void for_boxes(MayHold&& may_hold, Order&& order, Visit&& visit) {
    const auto place = [&](int level, std::int32_t child) {
      const DeviceBox& box = tree_.boxes[level][child];
      const double distance = box.square_distance(site_.x, site_.y);
      return may_hold(box, distance) ? place_by(order(box, distance)) : k_nowhere;
    };
    int visits = 0;
    constexpr int k_at_once = 4;
    visit_leaves<k_at_once>(
        tree_, place, [&](std::int32_t site) { return site >= 0 ? point(site) : site_; },
        [&](std::int32_t site, const Point2& at) {
          if (++visits > k_most_visits) fails_ = true;
          const bool is_anew = visit(site == rank_ ? -1 : site, at);
          return fails_ ? Seen::enough : is_anew ? Seen::anew : Seen::as_before;
        });
  }

  /// Moves `best` to a lane's site as long as one is better. \return whether one was
  template <class IsBetter, class Key, class Take>
  __device__ bool take_better(std::int32_t site, const Point2& p, IsBetter&& is_better, Key&& key, Take&& take) {
    bool mine = site >= 0 && is_better(p, site);
    int taken = 0;
    for (; taken <= 32; ++taken) {  // each is better than the one before
      const unsigned those = __ballot_sync(k_warp, mine);
      if (those == 0 || __any_sync(k_warp, fails_)) break;
      if (taken == 32) fails_ = true;
      const unsigned my_key = mine ? key(p) : ~0u, least = warp_min(my_key);
      const int chosen = __ffs(static_cast<int>(__ballot_sync(k_warp, mine && my_key == least))) - 1;
      take(Point2{__shfl_sync(k_warp, p.x, chosen), __shfl_sync(k_warp, p.y, chosen)},
           __shfl_sync(k_warp, site, chosen));
      mine = mine && is_better(p, site);
    }
    fails_ = __any_sync(k_warp, fails_);
    return taken > 0;
  }

  __device__ std::int32_t nearest() {
    std::int32_t best = -1;
    Point2 best_at{};
    double best_distance = INFINITY;
    for_boxes([&](const DeviceBox&, double distance) { return distance <= best_distance * (1 + 1e-9); },
              [](const DeviceBox&, double distance) { return distance; },
              [&](std::int32_t site, const Point2& at) {
                return take_better(
                    site, at,
                    [&](const Point2& p, std::int32_t) { return best < 0 || distance_order(site_, p, best_at) < 0; },
                    [&](const Point2& p) {
                      const double dx = p.x - site_.x, dy = p.y - site_.y;
                      return __float_as_uint(static_cast<float>(dx * dx + dy * dy));
                    },
                    [&](const Point2& p, std::int32_t taken) {
                      best = taken;
                      best_at = p;
                      const double dx = p.x - site_.x, dy = p.y - site_.y;
                      best_distance = dx * dx + dy * dy;
                    });
              });
    return fails_ ? -1 : best;
  }

  /// The neighbor after n, counter-clockwise where `turn_` is 1; -1 when the cell is open there.
  __device__ std::int32_t next_after(std::int32_t n) {
    const Point2 n_at = point(n);
    const double n_x = n_at.x - site_.x, n_y = n_at.y - site_.y;
    std::int32_t best = -1;
    Point2 best_at{};
    double center_x = 0, center_y = 0, radius2 = INFINITY;  // of the circle, from the site; large enough
    const auto is_left = [&](const Point2& from, const Point2& p) { return turn_ * turn_sign(site_, from, p) > 0; };
    const auto is_in_reach = [&](const Point2& p) {
      const double dx = p.x - site_.x - center_x, dy = p.y - site_.y - center_y;
      return radius2 == INFINITY || dx * dx + dy * dy <= radius2;
    };
    const auto is_better = [&](const Point2& p, std::int32_t site) {
      if (site == n || site == best || !is_in_reach(p) || !is_left(n_at, p)) return false;
      if (best < 0) return true;
      bool is_known;
      const int sign = known_circle_sign(n_at, best_at, p, site_, is_known);
      if (!is_known) fails_ = true;
      return sign == 0 ? is_left(best_at, p) : turn_ * sign < 0;
    };
    const auto key = [&](const Point2& p) {
      const double x = p.x - site_.x, y = p.y - site_.y;
      return ordered(static_cast<float>((x * (x - n_x) + y * (y - n_y)) / (turn_ * (n_x * y - n_y * x))));
    };
    const auto take = [&](const Point2& p, std::int32_t taken) {
      best = taken;
      best_at = p;
      const double x = p.x - site_.x, y = p.y - site_.y, cross = n_x * y - n_y * x;
      const double n2 = n_x * n_x + n_y * n_y, p2 = x * x + y * y;
      radius2 = INFINITY;
      center_x = (y * n2 - n_y * p2) / (2 * cross);
      center_y = (n_x * p2 - x * n2) / (2 * cross);
      const double radius = sqrt(center_x * center_x + center_y * center_y);
      constexpr double k_rounding = 2e-15;
      const double slack =
          k_rounding *
          (((fabs(x) + fabs(y)) * n2 + (fabs(n_x) + fabs(n_y)) * p2 + 2 * radius * (fabs(n_x * y) + fabs(n_y * x))) /
               fabs(cross) +
           4 * radius);
      if (slack < 0.1 * radius) radius2 = (radius + slack) * (radius + slack);  // or the circle's place is not known
    };
    const auto may_hold = [&](const DeviceBox& box, double) {
      const double low_x = box.low[0] - site_.x, low_y = box.low[1] - site_.y, high_x = box.high[0] - site_.x,
                   high_y = box.high[1] - site_.y, t_x = turn_ * n_x, t_y = turn_ * n_y;
      const double across = fmax(t_x * low_y, t_x * high_y), along = fmin(t_y * low_x, t_y * high_x);
      if (across - along <= -1e-14 * (fabs(across) + fabs(along))) return false;  // right of the line through n
      if (radius2 == INFINITY) return true;
      const double dx = fmax(fmax(low_x - center_x, center_x - high_x), 0.0),
                   dy = fmax(fmax(low_y - center_y, center_y - high_y), 0.0);
      return dx * dx + dy * dy <= radius2;
    };
    // No more than how far on the circle has to grow to touch a site in the box: from its center less and more.
    const auto order = [&](const DeviceBox& box, double) {
      const double half_x = 0.5 * (box.high[0] - box.low[0]), half_y = 0.5 * (box.high[1] - box.low[1]),
                   x = box.low[0] + half_x - site_.x, y = box.low[1] + half_y - site_.y,
                   from_x = fmax(fabs(x - 0.5 * n_x) - half_x, 0.0), from_y = fmax(fabs(y - 0.5 * n_y) - half_y, 0.0),
                   along = from_x * from_x + from_y * from_y - 0.25 * (n_x * n_x + n_y * n_y),
                   cross = turn_ * (n_x * y - n_y * x), more = fabs(n_x) * half_y + fabs(n_y) * half_x;
      return along / (along > 0 ? cross + more : fmax(cross - more, 1e-3 * more));
    };
    for_boxes(may_hold, order, [&](std::int32_t site, const Point2& at) {
      return take_better(site, at, is_better, key, take) || best < 0;
    });
    return best;
  }

  __device__ bool write(int ahead, int behind, bool is_open, const DeviceLists& lists) const {
    const int lane = threadIdx.x % 32, count = ahead + behind;
    const auto at = [&](int i) { return i < behind ? memory_.behind[behind - 1 - i] : memory_.ahead[i - behind]; };
    int first = 0;
    if (!is_open) {
      unsigned lowest = ~0u;
      for (int i = lane; i < count; i += 32) lowest = min(lowest, static_cast<unsigned>(at(i)));
      lowest = warp_min(lowest);
      unsigned place = ~0u;
      for (int i = lane; i < count; i += 32)
        if (static_cast<unsigned>(at(i)) == lowest) place = static_cast<unsigned>(i);
      first = static_cast<int>(warp_min(place));
    }
    std::int32_t* const to = place_for_list(lists, rank_, count);
    if (!to) return false;
    for (int i = lane; i < count; i += 32) to[i] = at((i + first) % count);
    if (lane == 0) {
      lists.counts[rank_] = count;
      lists.is_open[rank_] = is_open;
    }
    return true;
  }

  const DeviceTree& tree_;
  FarMemory& memory_;
  Point2 site_{};
  std::int32_t rank_ = 0;
  int turn_ = 1;
  bool fails_ = false;
};

constexpr int k_far_threads = 128;

/// Cells that a kernel takes one by one, and what it says of those that fail again.
struct FarCells {
  const std::int32_t* ranks;
  const int* count;
  const int* are_left;  ///< whether none is to be taken
  int* next;
  int* failures;
  int most_failures;

  /// Returns to a whole warp the next of them, -1 when there is none.
  __device__ std::int32_t take() const {
    const int all = *count;
    int i = 0;
    if (threadIdx.x % 32 == 0)
      i = *static_cast<const volatile int*>(are_left) || *static_cast<volatile int*>(failures) > most_failures
              ? all
              : atomicAdd(next, 1);
    i = __shfl_sync(k_warp, i, 0);
    return i < all ? ranks[i] : -1;
  }
};

// Every diagram runs it, and its stack is the largest of all kernels: the driver would get memory for a larger one in
// the midst of the work, which nothing can stop.
__global__ void __launch_bounds__(k_far_threads, 4) find_far_cells(DeviceTree tree, FarCells far, DeviceLists lists) {
  __shared__ FarMemory memory[k_far_threads / 32];
  FarCellBuilder builder(tree, memory[threadIdx.x / 32]);
  for (std::int32_t rank = far.take(); rank >= 0; rank = far.take()) {
    if (!builder.build(rank, lists) && threadIdx.x % 32 == 0) lists.far[atomicAdd(far.failures, 1)] = rank;
    __syncwarp();
  }
}

}  // namespace
}  // namespace saddleback::voronoi2d
