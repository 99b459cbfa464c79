#pragma once
// Decisions in the plane, for the processor and for devices. Every combinatorial decision on floating-point numbers:
// first in doubles with an error bound, exactly where that cannot tell. The bounds are those of [shewchuk1997] section
// 4. Coordinates must be finite and their products must not over- or underflow (a Mesh's are within 1e60; below 1e-60
// differences count as none there).

#include "predicates/expansion.h"

namespace saddleback::predicates {

enum class Sign : int { negative = -1, zero = 0, positive = 1 };

struct Point2 {
  double x, y;
};

namespace detail {

inline constexpr double k_epsilon = 0x1p-53;  // half the distance from 1 to the next double
inline constexpr double k_orient_bound = (3 + 16 * k_epsilon) * k_epsilon;
inline constexpr double k_circle_bound = (10 + 96 * k_epsilon) * k_epsilon;

SADDLEBACK_HOST_DEVICE inline Sign to_sign(double value) {
  return value > 0 ? Sign::positive : value < 0 ? Sign::negative : Sign::zero;
}

/// Returns p.x q.y - p.y q.x of two differences, exactly.
SADDLEBACK_HOST_DEVICE inline Expansion<16> cross(const Expansion<2>& px, const Expansion<2>& py,
                                                  const Expansion<2>& qx, const Expansion<2>& qy) {
  return sum(product(px, qy), product(py, qx), -1);
}

SADDLEBACK_HOST_DEVICE inline Sign orient_2d_exact(const Point2& a, const Point2& b, const Point2& c) {
  return static_cast<Sign>(
      cross(difference(a.x, c.x), difference(a.y, c.y), difference(b.x, c.x), difference(b.y, c.y)).sign());
}

SADDLEBACK_HOST_DEVICE inline Sign in_circle_exact(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  const Expansion<2> ax = difference(a.x, d.x), ay = difference(a.y, d.y), bx = difference(b.x, d.x),
                     by = difference(b.y, d.y), cx = difference(c.x, d.x), cy = difference(c.y, d.y);
  const auto a_part = product(sum(product(ax, ax), product(ay, ay)), cross(bx, by, cx, cy));
  const auto b_part = product(sum(product(bx, bx), product(by, by)), cross(cx, cy, ax, ay));
  const auto c_part = product(sum(product(cx, cx), product(cy, cy)), cross(ax, ay, bx, by));
  return static_cast<Sign>(sum(sum(a_part, b_part), c_part).sign());
}

}  // namespace detail

/// Returns exactly whether a, b, c turn counter-clockwise (positive), clockwise (negative), or lie on one line (zero).
/// O(1).
SADDLEBACK_HOST_DEVICE inline Sign orient_2d(const Point2& a, const Point2& b, const Point2& c) {
  const double left = times(plus(a.x, -c.x), plus(b.y, -c.y)), right = times(plus(a.y, -c.y), plus(b.x, -c.x));
  const double det = plus(left, -right);
  if (fabs(det) > times(detail::k_orient_bound, plus(fabs(left), fabs(right)))) return detail::to_sign(det);
  return detail::orient_2d_exact(a, b, c);
}

/// Returns exactly whether d lies inside the circle through a, b, c (positive; negated if these turn clockwise) or on
/// it (zero). O(1).
SADDLEBACK_HOST_DEVICE inline Sign in_circle(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  const double ax = plus(a.x, -d.x), ay = plus(a.y, -d.y), bx = plus(b.x, -d.x), by = plus(b.y, -d.y),
               cx = plus(c.x, -d.x), cy = plus(c.y, -d.y);
  const double bxcy = times(bx, cy), cxby = times(cx, by), cxay = times(cx, ay), axcy = times(ax, cy),
               axby = times(ax, by), bxay = times(bx, ay);
  const double a_lift = plus(times(ax, ax), times(ay, ay)), b_lift = plus(times(bx, bx), times(by, by)),
               c_lift = plus(times(cx, cx), times(cy, cy));
  const double det =
      plus(plus(times(a_lift, plus(bxcy, -cxby)), times(b_lift, plus(cxay, -axcy))), times(c_lift, plus(axby, -bxay)));
  const double magnitude =
      plus(plus(times(plus(fabs(bxcy), fabs(cxby)), a_lift), times(plus(fabs(cxay), fabs(axcy)), b_lift)),
           times(plus(fabs(axby), fabs(bxay)), c_lift));
  if (fabs(det) > times(detail::k_circle_bound, magnitude)) return detail::to_sign(det);
  return detail::in_circle_exact(a, b, c, d);
}

/// Negative if p is nearer to a than to b, zero if equally far. O(1).
SADDLEBACK_HOST_DEVICE inline Sign compare_distances(const Point2& p, const Point2& a, const Point2& b) {
  const double ax = plus(a.x, -p.x), ay = plus(a.y, -p.y), bx = plus(b.x, -p.x), by = plus(b.y, -p.y);
  const double to_a = plus(times(ax, ax), times(ay, ay)), to_b = plus(times(bx, bx), times(by, by));
  const double det = plus(to_a, -to_b);
  if (fabs(det) > times(6 * detail::k_epsilon, plus(to_a, to_b))) return detail::to_sign(det);
  const Expansion<2> dax = difference(a.x, p.x), day = difference(a.y, p.y), dbx = difference(b.x, p.x),
                     dby = difference(b.y, p.y);
  const auto exact_a = sum(product(dax, dax), product(day, day)), exact_b = sum(product(dbx, dbx), product(dby, dby));
  return static_cast<Sign>(sum(exact_a, exact_b, -1).sign());
}

}  // namespace saddleback::predicates
