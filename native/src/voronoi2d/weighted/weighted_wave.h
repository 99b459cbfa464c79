#pragma once
// The view of one weighted site of others, in doubles with error bounds; see predicates/weighted_2d.h. For the
// processor and for devices, which compute the same to the bit.

#include <cmath>

#include "predicates/plane_predicates.h"
#include "predicates/weighted_point.h"

namespace saddleback::voronoi2d {

/// Another site as a linear function q.(u, 1) of the direction u, half the reciprocal of the distance at which it
/// becomes the nearer one: q, the sum of its coordinates' sizes, and by how much these may be off. All 0 for the
/// infinitely far.
struct Wave {
  double x, y, z, size, doubt;
};

/// Bounds crossings: where a wave rises above another. A crossing may be taken for a vertex as it is if it is off by
/// less than this, in parts of the height and of a full direction.
inline constexpr double k_good_crossing = 0x1p-36;
struct WaveCrossing {
  double x, y;    ///< direction
  double height;  ///< of both
  double blur;    ///< how far off the direction may be
  double doubt;   ///< by how much the height may be off

  SADDLEBACK_HOST_DEVICE bool is_good() const { return blur < k_good_crossing && doubt < k_good_crossing * height; }
};

// N is off by at most 6 roundings of the sum of its terms: each difference has one, which counts twice in its square,
// the square another, and the sums two.
SADDLEBACK_HOST_DEVICE inline Wave wave_at(const predicates::WeightedPoint2& here, double x, double y,
                                           double weight_difference, double weight_doubt) {
  constexpr double k_epsilon = predicates::detail::k_epsilon;
  const double dx = x - here.x, dy = y - here.y, e = weight_difference;
  const double terms = dx * dx + dy * dy + e * e, n = dx * dx + dy * dy - e * e;
  const double off = 6 * k_epsilon * terms + 2 * fabs(e) * weight_doubt;
  Wave result{dx / n, dy / n, e / n, 0, 0};
  result.size = fabs(result.x) + fabs(result.y) + fabs(result.z);
  result.doubt = off < 0.01 * n ? result.size * (4 * k_epsilon + 2 * off / n) + weight_doubt / n : double{INFINITY};
  return result;
}

SADDLEBACK_HOST_DEVICE inline Wave wave_of(const predicates::WeightedPoint2& here,
                                           const predicates::WeightedPoint2& other) {
  return wave_at(here, other.x, other.y, other.weight - here.weight, 0);
}

// With m = q_b - q_a, the direction is (-m_z m - sqrt(s) m') / m^2, m' being m turned left and s = m_x^2 + m_y^2 -
// m_z^2. If m is off by d, the direction is by 2 d / sqrt(s), as long as s is far from 0.
/// Returns where b rises above a, counter-clockwise.
SADDLEBACK_HOST_DEVICE inline WaveCrossing wave_crossing(const Wave& a, const Wave& b) {
  constexpr double k_epsilon = predicates::detail::k_epsilon, k_infinity = double{INFINITY};
  const double x = b.x - a.x, y = b.y - a.y, z = b.z - a.z;
  const double square = x * x + y * y, s = square - z * z;
  const double off = a.doubt + b.doubt + k_epsilon * (a.size + b.size);
  const double root = sqrt(s < 0 ? 0 : s), share = 1 / square;
  WaveCrossing result{(root * y - z * x) * share, (-root * x - z * y) * share, 0, k_infinity, k_infinity};
  const Wave& smaller = a.size < b.size ? a : b;  // both say how high, this one more exactly
  result.height = smaller.x * result.x + smaller.y * result.y + smaller.z;
  if (s > 16 * off * (a.size + b.size)) {
    result.blur = 8 * (off / root + k_epsilon);
    result.doubt = 2 * (smaller.doubt + smaller.size * result.blur);
  }
  return result;
}

/// Tells whether two waves certainly do not cross: one is above the other everywhere.
SADDLEBACK_HOST_DEVICE inline bool are_apart(const Wave& a, const Wave& b) {
  const double x = b.x - a.x, y = b.y - a.y, z = b.z - a.z;
  const double off = a.doubt + b.doubt + predicates::detail::k_epsilon * (a.size + b.size);
  return x * x + y * y - z * z < -16 * off * (a.size + b.size);
}

/// The point equally far from a site and two others whose waves cross there.
SADDLEBACK_HOST_DEVICE inline predicates::Point2 crossing_point(const predicates::WeightedPoint2& here, double x,
                                                                double y, double height) {
  return {here.x + 0.5 * x / height, here.y + 0.5 * y / height};
}

}  // namespace saddleback::voronoi2d
