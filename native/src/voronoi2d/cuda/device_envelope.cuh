#pragma once
// The cell of a weighted site, built by a warp. What the others make of it is an upper envelope of waves (see
// weighted_wave.h): from the wave that is highest in some direction on, counter-clockwise to where the next one rises
// above it, and so on around. Decided in doubles with error bounds: what these do not tell is not decided here.

#include "support/cuda/warp.cuh"
#include "voronoi2d/cuda/device_cells.cuh"
#include "voronoi2d/cuda/device_weighted_sites.cuh"

namespace saddleback::voronoi2d {
namespace {

constexpr int k_nobody = -1, k_unknown_rival = -2;

/// Works as `wave_of`, with nearly all digits where one site nearly hides the other and the squares cancel.
__device__ inline Wave careful_wave(const WeightedPoint2& here, const WeightedPoint2& other) {
  using namespace predicates;
  constexpr double k_epsilon = detail::k_epsilon, k_enough = 64 * k_epsilon;
  const Wave quick = wave_of(here, other);
  if (quick.doubt < k_enough * quick.size) return quick;
  double dx, dy, e, dx_rest, dy_rest, e_rest, xx, yy, ee, xx_rest, yy_rest, ee_rest, sum, n, sum_rest, n_rest;
  two_sum(other.x, -here.x, dx, dx_rest);
  two_sum(other.y, -here.y, dy, dy_rest);
  two_sum(other.weight, -here.weight, e, e_rest);
  two_product(dx, dx, xx, xx_rest);
  two_product(dy, dy, yy, yy_rest);
  two_product(e, e, ee, ee_rest);
  two_sum(xx, yy, sum, sum_rest);
  two_sum(sum, -ee, n, n_rest);
  n += n_rest + (sum_rest + (xx_rest + yy_rest - ee_rest) + 2 * (dx * dx_rest + dy * dy_rest - e * e_rest));
  const double off = 16 * k_epsilon * k_epsilon * (xx + yy + ee);  // what was left out, and roundings of the rests
  if (!(off < 0.01 * n)) return quick;
  Wave result{dx / n, dy / n, e / n, 0, 0};
  result.size = fabs(result.x) + fabs(result.y) + fabs(result.z);
  result.doubt = result.size * (8 * k_epsilon + 2 * off / n);
  return result;
}

struct Direction {
  double x, y, blur;
};
/// Says where building begins: none that sites on a lattice would single out.
__device__ constexpr Direction k_start{0.5403023058681398, 0.8414709848078965, 0x1p-51};

/// Returns how far it is from one direction to another, counter-clockwise: from 0 to 4, along the square about them.
__device__ inline double turned(const Direction& from, double x, double y) {
  const double across = from.x * y - from.y * x, along = from.x * x + from.y * y;
  const double share = fmin(fabs(across), fabs(along)) / (fabs(across) + fabs(along));
  const bool is_steep = fabs(across) > fabs(along);
  if (across >= 0) {
    if (along >= 0) return is_steep ? 1 - share : share;
    return is_steep ? 1 + share : 2 - share;
  }
  if (along < 0) return is_steep ? 3 - share : 2 + share;
  return is_steep ? 3 + share : 4 - share;
}
__device__ inline double turn_doubt(double blur, double other_blur) { return 8 * (blur + other_blur) + 0x1p-49; }

/// The least of many numbers that may be off: of a lane, then of the warp.
struct Least {
  double value = INFINITY, doubt = 0;
  int at = k_nobody;
  double others_low = INFINITY;

  __device__ void take(double other, double other_doubt, int other_at) {
    if (other + other_doubt < value + doubt) {
      others_low = fmin(others_low, value - doubt);
      value = other, doubt = other_doubt, at = other_at;
    } else {
      others_low = fmin(others_low, other - other_doubt);
    }
  }
  /// Returns a bound that the warp's least does not exceed.
  __device__ float warp_bound() const { return disordered(warp_min(ordered(__double2float_ru(value + doubt)))); }

  /// The lane that certainly has the least; k_nobody when none has any, k_unknown_rival when it is not certain.
  __device__ int lane() const {
    const double low = value - doubt;
    const float bound = warp_bound();
    if (!(bound < INFINITY)) return k_nobody;
    const unsigned near = __ballot_sync(k_warp, __double2float_rd(low) <= bound);
    if (__popc(near) == 1 && !__any_sync(k_warp, __double2float_rd(others_low) <= bound))
      return __ffs(static_cast<int>(near)) - 1;
    double least = value + doubt;
    for (int step = 16; step > 0; step /= 2) least = fmin(least, __shfl_xor_sync(k_warp, least, step));
    const unsigned nearer = __ballot_sync(k_warp, low <= least);
    if (__popc(nearer) != 1 || __any_sync(k_warp, others_low <= least)) return k_unknown_rival;
    return __ffs(static_cast<int>(nearer)) - 1;
  }
};

/// Decides about a wave that may rise above the present one: when, to `least`. False when that is not certain.
__device__ inline bool take_rise(const Wave& present, const Direction& from, const Wave& other, int at, Least& least) {
  const WaveCrossing crossing = wave_crossing(present, other);
  if (!(crossing.blur < INFINITY)) return are_apart(present, other) && other.z < present.z;
  const double turn = turned(from, crossing.x, crossing.y), doubt = turn_doubt(from.blur, crossing.blur);
  least.take(turn, doubt, at);
  return doubt < turn && turn < 4 - doubt;
}

struct Rise {
  int at;
  double turn, doubt;
};

/// Winds a cell among candidates, who have
///   int highest(Direction)           the one whose wave is highest, or k_unknown_rival;
///   Wave wave(at)                    how the site sees it;
///   Rise next(at, Wave, Direction)   the first to rise above it, k_nobody or k_unknown_rival.
/// Calls keep(at, WaveCrossing) for those that rise and where they do, in turn, the first one at last; false stops.
/// False also when something is not certain.
template <class Candidates, class Keep>
__device__ bool build_envelope(Candidates& candidates, Keep&& keep) {
  const int first = candidates.highest(k_start);
  if (first == k_unknown_rival) return false;
  Direction from = k_start;
  Wave present = candidates.wave(first);
  int at = first, count = 0;
  while (true) {
    const Rise rise = candidates.next(at, present, from);
    if (rise.at == k_unknown_rival) return false;
    const double left = count == 0 ? 4 : turned(from, k_start.x, k_start.y);
    const double left_doubt = turn_doubt(from.blur, k_start.blur);
    if (rise.at == k_nobody || rise.turn - rise.doubt > left + left_doubt) break;
    if (!(rise.turn + rise.doubt < left - left_doubt)) return false;
    const Wave next = candidates.wave(rise.at);
    const WaveCrossing crossing = wave_crossing(present, next);
    if (!keep(rise.at, crossing)) return false;
    ++count;
    at = rise.at;
    present = next;
    from = {crossing.x, crossing.y, crossing.blur};
  }
  return count > 1 && at == first;
}

}  // namespace
}  // namespace saddleback::voronoi2d
