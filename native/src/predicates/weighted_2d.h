#pragma once
// Decisions about weighted sites in the plane: a site with weight w at p is |x - p| - w away from x.
//
// Seen from a site, in direction u, the points as far from it as from another one lie at the distance 1 / (2 f(u)) with
// f(u) = (D.u + e) / N, where D is the way to the other site, e its weight less that of the first, and N = D^2 - e^2,
// which is positive as neither hides the other. With q = (D, e) / N this is linear: f(u) = q.(u, 1). The site's cell
// ends where the largest f of all others does. Two of them cross at a direction whose coordinates have one square root;
// no decision here takes a polynomial of more than degree twelve. The usual tests of circles tangent to three others
// take 14 and more [emiris2006]; that eight are enough for the circle test was found in [millman2007].

#include "predicates/predicates.h"
#include "predicates/weighted_point.h"

namespace saddleback::predicates {

/// True when a is nowhere farther than b, from inside or from outside: |a - b| <= w_a - w_b. Exact.
bool hides(const WeightedPoint2& a, const WeightedPoint2& b);

/// Negative if p is nearer to a than to b, zero if equally far. Exact.
Sign compare_weighted_distances(const Point2& p, const WeightedPoint2& a, const WeightedPoint2& b);

/// A direction from a site: where, counter-clockwise, `after` becomes nearer than `before`. The null pointer stands for
/// a site infinitely far away, whose f is 0. Or one of three fixed directions, with a neighbor that is nearest there.
struct Crossing {
  const WeightedPoint2 *before, *after;
  int fixed = -1;
};

/// The fixed directions (x, y) / z; from one to the next it is less than half a turn.
struct FixedDirection {
  double x, y, z;
};
inline constexpr FixedDirection k_fixed_directions[3] = {{1, 0, 1}, {-3, 4, 5}, {-3, -4, 5}};

/// Sign of f of `other` less that of the crossing there. Exact. None of the sites may hide another.
Sign compare_at_crossing(const WeightedPoint2& site, const Crossing& crossing, const WeightedPoint2* other);

/// Sign of the turn from the crossing to the direction in which f of b less f of a is largest. Exact.
Sign turn_from_crossing(const WeightedPoint2& site, const Crossing& crossing, const WeightedPoint2* a,
                        const WeightedPoint2* b);

/// A crossing to the last few digits, however flat the sites lie: the direction, and f there, which is not below 0.
struct CrossingPlace {
  double x, y, height;
};
CrossingPlace crossing_place(const WeightedPoint2& site, const Crossing& crossing);

}  // namespace saddleback::predicates
