#pragma once
// Exact orientation of three places of the plane.

#include "saddleback/types.h"

#include "predicates/predicates.h"

namespace saddleback::charts {

/// Returns the sign of the turn a, b, c: positive if counter-clockwise.
inline predicates::Sign turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return predicates::orient_2d({a.x(), a.y()}, {b.x(), b.y()}, {c.x(), c.y()});
}

}  // namespace saddleback::charts
