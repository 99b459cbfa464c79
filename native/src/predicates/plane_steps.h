#pragma once
// Decisions in the plane in more steps, for processors. Coordinates of few digits, as those of a grid, need no exact
// arithmetic: doubles are exact then. The circle test also looks at floating-point numbers between doubles and exact
// ones: many sites that are on one circle but for the rounding of their coordinates cost little then.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "predicates/plane_predicates.h"

namespace saddleback::predicates {

namespace detail {

/// The test as `in_circle` begins it, in any binary numbers with room for doubles. True if `sign` is certain; the bound
/// of [shewchuk1997] section 4 for half a unit of the last place of theirs.
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
  sign = det > 0 ? Sign::positive : det < 0 ? Sign::negative : Sign::zero;
  return std::fabs(det) > k_bound * magnitude;
}

/// Tells whether the points' coordinates are multiples of a power of two that is `Bits` binary places below the largest
/// of their differences from the last one: of so many digits and one more at most, these are exact in doubles.
template <int Bits, std::size_t Count>
bool have_few_digits(const Point2 (&points)[Count]) {
  const Point2& last = points[Count - 1];
  double largest = 0;
  for (const Point2& p : points) largest = std::max({largest, std::fabs(p.x - last.x), std::fabs(p.y - last.y)});
  constexpr std::uint64_t k_exponent = 0x7ffull << 52;
  const double power = std::bit_cast<double>(std::bit_cast<std::uint64_t>(largest) & k_exponent);
  const double unit = power / static_cast<double>(1ull << Bits), reach = 0x1p51 * unit, shift = 3 * reach;
  const auto is_multiple = [&](double value) {  // one that lost no digit where the last one is a unit
    return (std::fabs(value) <= reach) & ((value + shift) - shift == value);
  };
  bool are_multiples = power > 0;
  for (const Point2& p : points) are_multiples &= is_multiple(p.x) & is_multiple(p.y);
  return are_multiples;
}

/// Whether long double computes in 64 bits. Windows has processors round it to the 53 of double.
#ifdef _WIN32
inline constexpr bool k_has_long_double = false;
#else
inline constexpr bool k_has_long_double = std::numeric_limits<long double>::digits == 64;
#endif

}  // namespace detail

/// Returns what `orient_2d` says. O(1).
inline Sign orient_2d_by_steps(const Point2& a, const Point2& b, const Point2& c) {
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x), det = left - right;
  if (std::fabs(det) > detail::k_orient_bound * (std::fabs(left) + std::fabs(right)) ||
      detail::have_few_digits<24>({a, b, c}))
    return detail::to_sign(det);
  return detail::orient_2d_exact(a, b, c);
}

/// Returns what `in_circle` says. O(1).
inline Sign in_circle_by_steps(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  Sign sign;
  if (detail::find_in_circle<double>(a, b, c, d, sign)) return sign;
  if (detail::have_few_digits<11>({a, b, c, d})) return sign;
  if constexpr (detail::k_has_long_double)
    if (detail::find_in_circle<long double>(a, b, c, d, sign)) return sign;
  return detail::in_circle_exact(a, b, c, d);
}

}  // namespace saddleback::predicates
