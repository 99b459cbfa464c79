#pragma once
// The place of a vertex between cells by powers.

#include "saddleback/types.h"

#include "predicates/power_2d.h"

namespace saddleback::voronoi2d {

/// The point where the powers of three sites, counter-clockwise and not on a line, are equal: to a few roundings of its
/// distance from the first of them and of their coordinates.
Vec2 power_center(const predicates::PowerPoint2& a, const predicates::PowerPoint2& b, const predicates::PowerPoint2& c);

}  // namespace saddleback::voronoi2d
