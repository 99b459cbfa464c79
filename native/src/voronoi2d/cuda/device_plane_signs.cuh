#pragma once
// How three sites turn, and on which side of a circle a fourth lies: first in doubles. What these do not tell is rare,
// and found by functions of their own that cost those who do not call them no registers. They take values: what is
// referred to would have to be in memory.

#include "predicates/plane_predicates.h"

namespace saddleback::voronoi2d {
namespace {

using predicates::Point2;

SADDLEBACK_RARE inline int exact_turn_sign(Point2 a, Point2 b, Point2 c) {
  return static_cast<int>(predicates::detail::orient_2d_exact(a, b, c));
}
SADDLEBACK_RARE inline int exact_distance_order(Point2 p, Point2 a, Point2 b) {
  return static_cast<int>(predicates::compare_distances(p, a, b));
}

SADDLEBACK_HOST_DEVICE inline int quick_turn_sign(const Point2& a, const Point2& b, const Point2& c, bool& is_known) {
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x), det = left - right;
  is_known = fabs(det) > predicates::detail::k_orient_bound * (fabs(left) + fabs(right));
  return (det > 0) - (det < 0);
}

/// Works as predicates::orient_2d.
SADDLEBACK_HOST_DEVICE inline int turn_sign(const Point2& a, const Point2& b, const Point2& c) {
  bool is_known;
  const int sign = quick_turn_sign(a, b, c, is_known);
  return is_known ? sign : exact_turn_sign(a, b, c);
}

/// Works as predicates::compare_distances.
SADDLEBACK_HOST_DEVICE inline int distance_order(const Point2& p, const Point2& a, const Point2& b) {
  const double ax = a.x - p.x, ay = a.y - p.y, bx = b.x - p.x, by = b.y - p.y;
  const double to_a = ax * ax + ay * ay, to_b = bx * bx + by * by, det = to_a - to_b;
  const bool is_known = fabs(det) > 6 * predicates::detail::k_epsilon * (to_a + to_b);
  return is_known ? (det > 0) - (det < 0) : exact_distance_order(p, a, b);
}

/// The sign of the circle test for d, a, b, c, counted from d; `is_exact` when the terms have no rounding errors.
SADDLEBACK_HOST_DEVICE inline int circle_sign(double ax, double ay, double bx, double by, double cx, double cy,
                                              bool is_exact, bool& is_known) {
  const double bxcy = bx * cy, cxby = cx * by, cxay = cx * ay, axcy = ax * cy, axby = ax * by, bxay = bx * ay;
  const double a_lift = ax * ax + ay * ay, b_lift = bx * bx + by * by, c_lift = cx * cx + cy * cy;
  const double det = a_lift * (bxcy - cxby) + b_lift * (cxay - axcy) + c_lift * (axby - bxay);
  const double magnitude =
      (fabs(bxcy) + fabs(cxby)) * a_lift + (fabs(cxay) + fabs(axcy)) * b_lift + (fabs(axby) + fabs(bxay)) * c_lift;
  is_known = is_exact || fabs(det) > predicates::detail::k_circle_bound * magnitude;
  return (det > 0) - (det < 0);
}

/// A sum of two doubles, the second of which is at most half a last digit of the first.
struct TwiceAsLong {
  double high, low;

  SADDLEBACK_HOST_DEVICE static TwiceAsLong difference(double a, double b) {
    TwiceAsLong result;
    predicates::two_sum(a, -b, result.high, result.low);
    return result;
  }
  SADDLEBACK_HOST_DEVICE static TwiceAsLong of(double high, double low) {
    const double sum = predicates::plus(high, low);
    return {sum, predicates::plus(low, -predicates::plus(sum, -high))};
  }
  SADDLEBACK_HOST_DEVICE TwiceAsLong operator-() const { return {-high, -low}; }
  SADDLEBACK_HOST_DEVICE friend TwiceAsLong operator+(const TwiceAsLong& a, const TwiceAsLong& b) {
    double sum, rest;
    predicates::two_sum(a.high, b.high, sum, rest);
    return of(sum, predicates::plus(rest, predicates::plus(a.low, b.low)));
  }
  SADDLEBACK_HOST_DEVICE friend TwiceAsLong operator*(const TwiceAsLong& a, const TwiceAsLong& b) {
    double product, rest;
    predicates::two_product(a.high, b.high, product, rest);
    return of(product, fma(a.high, b.low, fma(a.low, b.high, rest)));
  }
};

constexpr int k_unknown_sign = 2;

/// Decides with twice as many digits.
SADDLEBACK_RARE inline int careful_circle_sign(Point2 a, Point2 b, Point2 c, Point2 d) {
  using Long = TwiceAsLong;
  const Long ax = Long::difference(a.x, d.x), ay = Long::difference(a.y, d.y), bx = Long::difference(b.x, d.x),
             by = Long::difference(b.y, d.y), cx = Long::difference(c.x, d.x), cy = Long::difference(c.y, d.y);
  Long det{0, 0};
  double magnitude = 0;
  const auto add = [&](const Long& px, const Long& py, const Long& qx, const Long& qy, const Long& rx, const Long& ry) {
    const Long lift = px * px + py * py, left = qx * ry, right = rx * qy;
    det = det + lift * (left + -right);
    magnitude += lift.high * (fabs(left.high) + fabs(right.high));
  };
  add(ax, ay, bx, by, cx, cy);
  add(bx, by, cx, cy, ax, ay);
  add(cx, cy, ax, ay, bx, by);
  // Some thirty roundings of 2^-104 each; below the least magnitude products lose their last digits.
  constexpr double k_bound = 0x1p-98, k_least = 0x1p-900;
  const bool is_known = fabs(det.high) > k_bound * magnitude && magnitude > k_least;
  return is_known ? (det.high > 0) - (det.high < 0) : k_unknown_sign;
}

/// One of three: a point's square distance times how two others turn, all counted from the fourth.
SADDLEBACK_RARE inline predicates::Expansion<32> circle_term(Point2 p, Point2 q, Point2 r) {
  const auto exact = [](double value) { return predicates::Expansion<1>{{value}, value != 0 ? 1 : 0}; };
  const predicates::Expansion<1> px = exact(p.x), py = exact(p.y), qx = exact(q.x), qy = exact(q.y), rx = exact(r.x),
                                 ry = exact(r.y);
  return product(sum(product(px, px), product(py, py)), sum(product(qx, ry), product(qy, rx), -1));
}

/// The sign of the circle test for d, a, b, c, exactly. Unknown where a difference from d has more digits than a
/// double.
SADDLEBACK_RARE inline int exact_circle_sign(Point2 a, Point2 b, Point2 c, Point2 d) {
  bool is_known = true;
  const auto away = [&](double value, double from) {
    double sum, rest;
    predicates::two_sum(value, -from, sum, rest);
    is_known = is_known && rest == 0;
    return sum;
  };
  const auto from_d = [&](const Point2& p) { return Point2{away(p.x, d.x), away(p.y, d.y)}; };
  const Point2 p = from_d(a), q = from_d(b), r = from_d(c);
  if (!is_known) return k_unknown_sign;
  return sum(sum(circle_term(p, q, r), circle_term(q, r, p)), circle_term(r, p, q)).sign();
}

/// Decides where doubles do not tell.
SADDLEBACK_HOST_DEVICE inline int rare_circle_sign(const Point2& a, const Point2& b, const Point2& c, const Point2& d,
                                                   bool& is_known) {
  int sign = careful_circle_sign(a, b, c, d);
  if (sign == k_unknown_sign) sign = exact_circle_sign(a, b, c, d);
  is_known = sign != k_unknown_sign;
  return is_known ? sign : 0;
}

SADDLEBACK_HOST_DEVICE inline int quick_circle_sign(const Point2& a, const Point2& b, const Point2& c, const Point2& d,
                                                    bool& is_known) {
  return circle_sign(a.x - d.x, a.y - d.y, b.x - d.x, b.y - d.y, c.x - d.x, c.y - d.y, false, is_known);
}

/// Works as predicates::in_circle, by as few digits as tell it. Unknown where it takes more than `exact_circle_sign`
/// has.
SADDLEBACK_HOST_DEVICE inline int known_circle_sign(const Point2& a, const Point2& b, const Point2& c, const Point2& d,
                                                    bool& is_known) {
  const int sign = quick_circle_sign(a, b, c, d, is_known);
  return is_known ? sign : rare_circle_sign(a, b, c, d, is_known);
}

}  // namespace
}  // namespace saddleback::voronoi2d
