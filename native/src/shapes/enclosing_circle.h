#pragma once
// The smallest circle around points of the plane.

#include <span>

#include "saddleback/types.h"

namespace saddleback::distribution {

struct Circle {
  Vec2 center;
  double radius;
};

/// Finds the circle, up to rounding. The points must not be empty. O(n) expected for points in no particular order,
/// O(n^3) at worst [welzl1991].
Circle enclosing_circle(std::span<const Vec2> points);

}  // namespace saddleback::distribution
