#pragma once
// The place of a vertex of a weighted diagram, seen from the lowest of its sites.

#include "saddleback/types.h"

#include "predicates/weighted_2d.h"
#include "voronoi2d/weighted/weighted_wave.h"

namespace saddleback::voronoi2d {

/// Returns the vertex of a crossing that is good.
inline Vec2 vertex_at(const predicates::WeightedPoint2& here, const WaveCrossing& crossing) {
  const predicates::Point2 place = crossing_point(here, crossing.x, crossing.y, crossing.height);
  return {place.x, place.y};
}

/// Returns the vertex of one that is not: in digits enough, however flat the sites lie.
inline Vec2 rough_vertex(const predicates::WeightedPoint2& here, const predicates::WeightedPoint2* before,
                         const predicates::WeightedPoint2* after) {
  const predicates::CrossingPlace found = predicates::crossing_place(here, {before, after});
  const predicates::Point2 place = crossing_point(here, found.x, found.y, found.height);
  return {place.x, place.y};
}

}  // namespace saddleback::voronoi2d
