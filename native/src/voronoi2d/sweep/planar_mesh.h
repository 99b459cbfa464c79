#pragma once
// Triangulations of some sites as flat arrays.

#include <cmath>

#include "saddleback/types.h"

#include "predicates/plane_steps.h"
#include "predicates/predicates.h"
#include "support/simd/two_doubles.h"

namespace saddleback::voronoi2d {

/// Half-edge 4 t + k goes from corner k of triangle t to the next corner, counter-clockwise; k = 3 is not used.
inline Index next_half(Index half) { return (half & 3) == 2 ? half - 2 : half + 1; }
inline Index previous_half(Index half) { return (half & 3) == 0 ? half + 2 : half - 1; }

/// A view: the arrays belong to others.
struct PlanarMesh {
  const double *x, *y;  ///< sites
  Index site_count;
  Index* triangles;  ///< corners
  Index* twins;      ///< k_none at the border
  Index triangle_count;

  predicates::Point2 point(Index site) const { return {x[site], y[site]}; }
  Index half_end() const { return 4 * triangle_count; }
};

/// Returns where the four sites about an edge between two triangles lie: `positive` when the triangles must be
/// exchanged for the other two, `zero` when they share a Voronoi vertex. Exact.
predicates::Sign circle_test(const PlanarMesh& mesh, Index half);

/// The circle through three sites, ready to be asked about others: the minors of the determinant of `in_circle` along
/// the row of the fourth site, counted from the first. With q the largest squared distance from the first site to any
/// other, the determinant is off by less than 12 roundings of 4 q^2.
struct CircleTest {
  double x, y;                   ///< the first site
  double by_x, by_y, by_square;  ///< minors
  double largest_square;
  static constexpr double k_bound = 50 * predicates::detail::k_epsilon;

  CircleTest(const predicates::Point2& a, const predicates::Point2& b, const predicates::Point2& c) : x(a.x), y(a.y) {
    const double bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
    const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
    by_x = cy * b2 - by * c2;
    by_y = bx * c2 - cx * b2;
    by_square = by * cx - bx * cy;
    largest_square = b2 > c2 ? b2 : c2;
  }
  /// Returns the room for two sites: positive if it is certainly outside the circle, when the three turn
  /// counter-clockwise.
  TwoDoubles room(const predicates::Point2& d, const predicates::Point2& e) const {
    using Two = TwoDoubles;
    const Two dx = Two::of(d.x, e.x) - Two::both(x), dy = Two::of(d.y, e.y) - Two::both(y), d2 = dx * dx + dy * dy;
    const Two value = dx * Two::both(by_x) + dy * Two::both(by_y) + d2 * Two::both(by_square);
    const Two largest = Two::larger(d2, Two::both(largest_square));
    return Two::both(-k_bound) * (largest * largest) - value;
  }
};

/// Exchanges the triangles beside an edge for the other two: p q r | q p s become p s r | s q r, where the half-edge
/// went from p to q.
void exchange_pair(PlanarMesh& mesh, Index half);

/// A triangulation of any distinct sites that are not all on one line, whatever the numbers: from the left, each site
/// is joined to the edges of the convex hull that it sees. For the rare ones that no sweep in doubles gets through.
/// `triangles` and `twins` have room for 2 n; sets `triangle_count`, 0 when all sites are on one line. O(n log n).
void triangulate_from_left(PlanarMesh& mesh);

}  // namespace saddleback::voronoi2d
