#pragma once
// Where a Voronoi vertex lies, for the processor and for devices.

#include "predicates/plane_predicates.h"

namespace saddleback::voronoi2d {

/// The point equally far from three sites, counter-clockwise, not on a line. Differences count from `a`; the
/// determinant is exact where it would lose digits, so that the relative error stays at a few roundings however flat
/// the triangle is. Overflows only where the point itself does.
SADDLEBACK_HOST_DEVICE inline predicates::Point2 circumcentre_point(const predicates::Point2& a,
                                                                    const predicates::Point2& b,
                                                                    const predicates::Point2& c) {
  using namespace predicates;
  const double bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
  const double left = bx * cy, right = by * cx;
  double det = left - right;
  constexpr double k_cancelled = 0x1p-10;
  if (fabs(det) < k_cancelled * (fabs(left) + fabs(right))) {
    const auto exact =
        detail::cross(difference(b.x, a.x), difference(b.y, a.y), difference(c.x, a.x), difference(c.y, a.y));
    det = 0;
    for (int i = 0; i < exact.size; ++i) det += exact.terms[i];
  }
  const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
  return {a.x + 0.5 * ((cy * b2 - by * c2) / det), a.y + 0.5 * ((bx * c2 - cx * b2) / det)};
}

}  // namespace saddleback::voronoi2d
