#pragma once
// The place of a Voronoi vertex, for the processor and for devices.

#include "predicates/plane_predicates.h"

namespace saddleback::voronoi2d {

/// The terms of a product less another's, summed up from the smallest; all that `predicates::detail::cross` comes to
/// where no difference has a rest.
SADDLEBACK_HOST_DEVICE inline double careful_difference(double a, double b, double c, double d) {
  using namespace predicates;
  double left, left_rest, right, right_rest;
  two_product(a, b, left, left_rest);
  two_product(c, d, right, right_rest);
  right = -right;
  right_rest = -right_rest;
  const bool left_first = fabs(left_rest) < fabs(right_rest);
  const double first = left_first ? left_rest : right_rest;
  const double next_left = left_first ? left : left_rest, next_right = left_first ? right_rest : right;
  const bool left_next = fabs(next_left) < fabs(next_right);
  const double second = left_next ? next_left : next_right;
  double third = left_first ? right_rest : left_rest, fourth = left_first ? right : left;  // both of one
  if (left_first != left_next) {
    const bool left_third = fabs(left) < fabs(right);
    third = left_third ? left : right;
    fourth = left_third ? right : left;
  }
  double total, rest_1, rest_2, rest_3;
  two_sum(first, second, total, rest_1);
  two_sum(total, third, total, rest_2);
  two_sum(total, fourth, total, rest_3);
  return plus(plus(plus(rest_1, rest_2), rest_3), total);
}

/// Returns the cross product of b - a and c - a, exact but for the last digit.
SADDLEBACK_RARE inline double summed_cross(predicates::Point2 a, predicates::Point2 b, predicates::Point2 c) {
  using predicates::difference;
  const auto exact =
      predicates::detail::cross(difference(b.x, a.x), difference(b.y, a.y), difference(c.x, a.x), difference(c.y, a.y));
  double sum = 0;
  for (int i = 0; i < exact.size; ++i) sum += exact.terms[i];
  return sum;
}

/// The share of its terms below which a determinant is summed up exactly, so as to keep all its digits but a few.
constexpr double k_cancelled = 0x1p-5;

/// The point equally far from three sites, differences counted from the first.
SADDLEBACK_HOST_DEVICE inline predicates::Point2 circumcenter_from(const predicates::Point2& a,
                                                                   const predicates::Point2& b,
                                                                   const predicates::Point2& c) {
  using namespace predicates;
  const double bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
  const double left = bx * cy, right = by * cx;
  double det = left - right;
  if (fabs(det) < k_cancelled * (fabs(left) + fabs(right))) {
    double ux, uy, vx, vy, rests[4];
    two_sum(b.x, -a.x, ux, rests[0]);
    two_sum(b.y, -a.y, uy, rests[1]);
    two_sum(c.x, -a.x, vx, rests[2]);
    two_sum(c.y, -a.y, vy, rests[3]);
    if (rests[0] == 0 && rests[1] == 0 && rests[2] == 0 && rests[3] == 0) {  // as of most that lie so close together
      det = careful_difference(ux, vy, uy, vx);
    } else {
      det = summed_cross(a, b, c);
    }
  }
  const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
  return {a.x + 0.5 * ((cy * b2 - by * c2) / det), a.y + 0.5 * ((bx * c2 - cx * b2) / det)};
}

SADDLEBACK_HOST_DEVICE inline double squared_distance(const predicates::Point2& a, const predicates::Point2& b) {
  const double x = b.x - a.x, y = b.y - a.y;
  return x * x + y * y;
}

/// The point equally far from three sites, counter-clockwise, not on a line, to a few roundings of its distance from
/// them and of their coordinates. Differences count from the corner opposite the longest side: with both of them no
/// longer than that side, what cancels is no more than the result, however near each other two of the sites are and
/// however flat the triangle is. Overflows only where the point itself does.
SADDLEBACK_HOST_DEVICE inline predicates::Point2 circumcenter_point(const predicates::Point2& a,
                                                                    const predicates::Point2& b,
                                                                    const predicates::Point2& c) {
  const double ab = squared_distance(a, b), bc = squared_distance(b, c), ca = squared_distance(c, a);
  if (bc >= ab && bc >= ca) return circumcenter_from(a, b, c);
  return ca >= ab ? circumcenter_from(b, c, a) : circumcenter_from(c, a, b);
}

}  // namespace saddleback::voronoi2d
