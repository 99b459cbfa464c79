#pragma once
// The circle test of the plane in three steps, for processors with floating-point numbers between doubles and exact
// ones: many sites that are on one circle but for the rounding of their coordinates cost little then.

#include <cmath>
#include <limits>

#include "predicates/plane_predicates.h"

namespace saddleback::predicates {

namespace detail {

/// The test as `in_circle` begins it, in any binary numbers with room for doubles. True if `sign` is certain;
/// Shewchuk's bound (1997, section 4) for half a unit of the last place of theirs.
template <class Real>
bool find_in_circle(const Point2& a, const Point2& b, const Point2& c, const Point2& d, Sign& sign) {
  constexpr Real k_unit = std::numeric_limits<Real>::epsilon() / 2, k_bound = (10 + 96 * k_unit) * k_unit;
  const Real dx = d.x, dy = d.y, ax = a.x - dx, ay = a.y - dy, bx = b.x - dx, by = b.y - dy, cx = c.x - dx,
             cy = c.y - dy;
  const Real bxcy = bx * cy, cxby = cx * by, cxay = cx * ay, axcy = ax * cy, axby = ax * by, bxay = bx * ay;
  const Real a_lift = ax * ax + ay * ay, b_lift = bx * bx + by * by, c_lift = cx * cx + cy * cy;
  const Real det = a_lift * (bxcy - cxby) + b_lift * (cxay - axcy) + c_lift * (axby - bxay);
  const Real magnitude = (std::fabs(bxcy) + std::fabs(cxby)) * a_lift + (std::fabs(cxay) + std::fabs(axcy)) * b_lift +
                         (std::fabs(axby) + std::fabs(bxay)) * c_lift;
  sign = det > 0 ? Sign::positive : Sign::negative;
  return std::fabs(det) > k_bound * magnitude;
}

}  // namespace detail

/// What `in_circle` says. O(1).
inline Sign in_circle_by_steps(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  Sign sign;
  if (detail::find_in_circle<double>(a, b, c, d, sign)) return sign;
  if constexpr (std::numeric_limits<long double>::digits == 64)
    if (detail::find_in_circle<long double>(a, b, c, d, sign)) return sign;
  return detail::in_circle_exact(a, b, c, d);
}

}  // namespace saddleback::predicates
