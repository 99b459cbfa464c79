#pragma once
// The place of a Voronoi vertex.

#include "saddleback/types.h"

#include "support/simd/two_doubles.h"
#include "voronoi2d/diagram/circumcenter_point.h"

namespace saddleback::voronoi2d {

/// See `circumcenter_point`.
inline Vec2 circumcenter(const predicates::Point2& a, const predicates::Point2& b, const predicates::Point2& c) {
  const predicates::Point2 center = circumcenter_point(a, b, c);
  return {center.x, center.y};
}

/// Sites by rank.
struct SiteColumns {
  const double *x, *y;
};

/// The numbers of `circumcenter_point` for two triangles side by side: those of their centers, and where they are good;
/// elsewhere digits are lost.
struct TwoCenters {
  TwoDoubles x, y, certainty;

  TwoCenters(const SiteColumns& sites, const Index* first, const Index* second) {
    using Two = TwoDoubles;
    const auto at = [&](const double* column, int k) { return Two::of(column[first[k]], column[second[k]]); };
    const Two ax = at(sites.x, 0), ay = at(sites.y, 0), bx = at(sites.x, 1), by = at(sites.y, 1), cx = at(sites.x, 2),
              cy = at(sites.y, 2);
    const Two abx = bx - ax, aby = by - ay, bcx = cx - bx, bcy = cy - by, cax = ax - cx, cay = ay - cy;
    const Two ab = abx * abx + aby * aby, bc = bcx * bcx + bcy * bcy, ca = cax * cax + cay * cay;
    // From the corner opposite the longest side.
    const Two from_c = ab - Two::larger(bc, ca), from_b = ca - bc;
    const auto choose = [&](Two a, Two b, Two c) {
      return Two::if_positive(from_c, c, Two::if_positive(from_b, b, a));
    };
    const Two ux = choose(abx, bcx, cax), uy = choose(aby, bcy, cay), u2 = choose(ab, bc, ca);
    const Two vx = choose(cax, abx, bcx), vy = choose(cay, aby, bcy), v2 = choose(ca, ab, bc);  // negated
    const Two left = ux * vy, right = uy * vx, det = right - left;
    x = choose(ax, bx, cx) - Two::both(0.5) * ((vy * u2 + uy * v2) / det);
    y = choose(ay, by, cy) + Two::both(0.5) * ((ux * v2 + vx * u2) / det);
    certainty = Two::size(det) - Two::both(k_cancelled) * (Two::size(left) + Two::size(right));
  }
  bool are_good() const { return TwoDoubles::are_positive(certainty); }
};

}  // namespace saddleback::voronoi2d
