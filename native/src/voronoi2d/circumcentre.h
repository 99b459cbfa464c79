#pragma once
// Where a Voronoi vertex lies.

#include "saddleback/types.h"

#include "support/two_doubles.h"
#include "voronoi2d/circumcentre_point.h"

namespace saddleback::voronoi2d {

/// See `circumcentre_point`.
inline Vec2 circumcentre(const predicates::Point2& a, const predicates::Point2& b, const predicates::Point2& c) {
  const predicates::Point2 centre = circumcentre_point(a, b, c);
  return {centre.x, centre.y};
}

/// Sites by rank.
struct SiteColumns {
  const double *x, *y;
};

/// The numbers of `circumcentre_point` for two triangles side by side: those of their centres, and where they are good;
/// elsewhere digits are lost.
struct TwoCentres {
  TwoDoubles x, y, certainty;

  TwoCentres(const SiteColumns& sites, const Index* first, const Index* second) {
    using Two = TwoDoubles;
    const auto at = [&](const double* column, int k) { return Two::of(column[first[k]], column[second[k]]); };
    const Two ax = at(sites.x, 0), ay = at(sites.y, 0);
    const Two ux = at(sites.x, 1) - ax, uy = at(sites.y, 1) - ay, vx = at(sites.x, 2) - ax, vy = at(sites.y, 2) - ay;
    const Two left = ux * vy, right = uy * vx, det = left - right;
    const Two u2 = ux * ux + uy * uy, v2 = vx * vx + vy * vy;
    x = ax + Two::both(0.5) * ((vy * u2 - uy * v2) / det);
    y = ay + Two::both(0.5) * ((ux * v2 - vx * u2) / det);
    constexpr double k_cancelled = 0x1p-10;  // as in `circumcentre_point`
    certainty = Two::size(det) - Two::both(k_cancelled) * (Two::size(left) + Two::size(right));
  }
  bool are_good() const { return TwoDoubles::are_positive(certainty); }
};

}  // namespace saddleback::voronoi2d
