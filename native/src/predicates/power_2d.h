#pragma once
// Decisions about powers in the plane: a site with weight w at p has the power |x - p|^2 - w at x. As those without
// weights (`plane_predicates.h`), with |x - p|^2 less the difference of weights in place of squared distances.

#include <cmath>

#include "predicates/plane_predicates.h"

namespace saddleback::predicates {

/// Coordinates and a weight whose products of two of either, and of four coordinates, neither over- nor underflow.
struct PowerPoint2 {
  double x, y, weight;

  Point2 place() const { return {x, y}; }
};

namespace detail {

/// The height of a above b, where the paraboloid above b's place is 0: |a - b|^2 less what a weighs more.
inline Expansion<18> lift(const PowerPoint2& a, const PowerPoint2& b) {
  const Expansion<2> x = difference(a.x, b.x), y = difference(a.y, b.y);
  return sum(sum(product(x, x), product(y, y)), difference(b.weight, a.weight));
}

/// Gives the same in doubles, and the sum of sizes that its rounding is counted from.
struct RoundedLift {
  double value, magnitude;

  RoundedLift(const PowerPoint2& a, const PowerPoint2& b) {
    const double x = a.x - b.x, y = a.y - b.y, squared = x * x + y * y, weight = b.weight - a.weight;
    value = squared + weight;
    magnitude = squared + std::fabs(weight);
  }
};

inline Sign power_test_exact(const PowerPoint2& a, const PowerPoint2& b, const PowerPoint2& c, const PowerPoint2& d) {
  const Expansion<2> ax = difference(a.x, d.x), ay = difference(a.y, d.y), bx = difference(b.x, d.x),
                     by = difference(b.y, d.y), cx = difference(c.x, d.x), cy = difference(c.y, d.y);
  const auto a_part = product(cross(bx, by, cx, cy), lift(a, d)), b_part = product(cross(cx, cy, ax, ay), lift(b, d)),
             c_part = product(cross(ax, ay, bx, by), lift(c, d));
  return static_cast<Sign>(sum(sum(a_part, b_part), c_part).sign());
}

}  // namespace detail

/// Returns exactly, of a, b, c that turn counter-clockwise, whether at the point where their powers are equal that of d
/// is less (positive), equal (zero) or greater. O(1).
inline Sign power_test(const PowerPoint2& a, const PowerPoint2& b, const PowerPoint2& c, const PowerPoint2& d) {
  const double ax = a.x - d.x, ay = a.y - d.y, bx = b.x - d.x, by = b.y - d.y, cx = c.x - d.x, cy = c.y - d.y;
  const double bxcy = bx * cy, cxby = cx * by, cxay = cx * ay, axcy = ax * cy, axby = ax * by, bxay = bx * ay;
  const detail::RoundedLift a_lift(a, d), b_lift(b, d), c_lift(c, d);
  const double det = a_lift.value * (bxcy - cxby) + b_lift.value * (cxay - axcy) + c_lift.value * (axby - bxay);
  const double magnitude = (std::fabs(bxcy) + std::fabs(cxby)) * a_lift.magnitude +
                           (std::fabs(cxay) + std::fabs(axcy)) * b_lift.magnitude +
                           (std::fabs(axby) + std::fabs(bxay)) * c_lift.magnitude;
  constexpr double k_bound = 16 * detail::k_epsilon;  // 10 without weights, whose difference and sum round twice more
  if (std::fabs(det) > k_bound * magnitude) return detail::to_sign(det);
  return detail::power_test_exact(a, b, c, d);
}

/// Returns exactly, of sites on one line, whether at the point of the line where the powers of a and b are equal that
/// of d is less (positive), equal (zero) or greater, if d lies between them; beyond b or a, whether d leaves that one
/// no part of the line (positive), or a point (zero). O(1).
inline Sign power_test_on_line(const PowerPoint2& a, const PowerPoint2& b, const PowerPoint2& d) {
  const bool by_x = a.x != b.x;
  const auto along = [&](const PowerPoint2& p) { return by_x ? difference(p.x, a.x) : difference(p.y, a.y); };
  const Expansion<2> to_b = along(b), to_d = along(d);
  const auto below = sum(product(detail::lift(b, a), to_d), product(detail::lift(d, a), to_b), -1);
  return static_cast<Sign>(below.sign() * to_b.sign());
}

/// Negative if a has the smaller power at p than b, zero if it is equal. O(1).
inline Sign compare_powers(const Point2& p, const PowerPoint2& a, const PowerPoint2& b) {
  const PowerPoint2 here{p.x, p.y, 0};
  const detail::RoundedLift to_a(a, here), to_b(b, here);
  const double value = to_a.value - to_b.value;
  if (std::fabs(value) > 8 * detail::k_epsilon * (to_a.magnitude + to_b.magnitude)) return detail::to_sign(value);
  return static_cast<Sign>(sum(detail::lift(a, here), detail::lift(b, here), -1).sign());
}

}  // namespace saddleback::predicates
