#pragma once
// Where a Voronoi vertex lies.

#include "saddleback/types.h"

#include "voronoi2d/circumcentre_point.h"

namespace saddleback::voronoi2d {

/// See `circumcentre_point`.
inline Vec2 circumcentre(const predicates::Point2& a, const predicates::Point2& b, const predicates::Point2& c) {
  const predicates::Point2 centre = circumcentre_point(a, b, c);
  return {centre.x, centre.y};
}

}  // namespace saddleback::voronoi2d
