#pragma once
// What one weighted site sees of others, in doubles with error bounds; see predicates/weighted_2d.h.

#include <algorithm>
#include <cmath>
#include <limits>

#include "predicates/weighted_2d.h"

namespace saddleback::voronoi2d {

/// Another site as a linear function q.(u, 1) of the direction u, half the reciprocal of the distance at which it
/// becomes the nearer one: q, the sum of its coordinates' sizes, and by how much these may be off. All 0 for the
/// infinitely far.
struct Wave {
  double x, y, z, size, doubt;
};

/// Where a wave rises above another.
struct WaveCrossing {
  double x, y;    ///< direction
  double height;  ///< of both
  double blur;    ///< how far off the direction may be
  double doubt;   ///< by how much the height may be off
};

// N is off by at most 6 roundings of the sum of its terms: each difference has one, which counts twice in its square,
// the square another, and the sums two.
inline Wave wave_at(const predicates::WeightedPoint2& here, double x, double y, double weight_difference,
                    double weight_doubt) {
  constexpr double k_epsilon = predicates::detail::k_epsilon;
  const double dx = x - here.x, dy = y - here.y, e = weight_difference;
  const double terms = dx * dx + dy * dy + e * e, n = dx * dx + dy * dy - e * e;
  const double off = 6 * k_epsilon * terms + 2 * std::fabs(e) * weight_doubt;
  Wave result{dx / n, dy / n, e / n, 0, 0};
  result.size = std::fabs(result.x) + std::fabs(result.y) + std::fabs(result.z);
  result.doubt = off < 0.01 * n ? result.size * (4 * k_epsilon + 2 * off / n) + weight_doubt / n
                                : std::numeric_limits<double>::infinity();
  return result;
}

inline Wave wave_of(const predicates::WeightedPoint2& here, const predicates::WeightedPoint2& other) {
  return wave_at(here, other.x, other.y, other.weight - here.weight, 0);
}

// With m = q_b - q_a, the direction is (-m_z m - sqrt(s) m') / m^2, m' being m turned left and s = m_x^2 + m_y^2 -
// m_z^2. If m is off by d, the direction is by 2 d / sqrt(s), as long as s is far from 0.
/// Where b rises above a, counter-clockwise.
inline WaveCrossing wave_crossing(const Wave& a, const Wave& b) {
  constexpr double k_epsilon = predicates::detail::k_epsilon, k_infinity = std::numeric_limits<double>::infinity();
  const double x = b.x - a.x, y = b.y - a.y, z = b.z - a.z;
  const double square = x * x + y * y, s = square - z * z;
  const double off = a.doubt + b.doubt + k_epsilon * (a.size + b.size);
  const double root = std::sqrt(std::max(s, 0.0)), share = 1 / square;
  WaveCrossing result{(root * y - z * x) * share, (-root * x - z * y) * share, 0, k_infinity, k_infinity};
  const Wave& smaller = a.size < b.size ? a : b;  // both say how high, this one more exactly
  result.height = smaller.x * result.x + smaller.y * result.y + smaller.z;
  if (s > 16 * off * (a.size + b.size)) {
    result.blur = 8 * (off / root + k_epsilon);
    result.doubt = 2 * (smaller.doubt + smaller.size * result.blur);
  }
  return result;
}

}  // namespace saddleback::voronoi2d
