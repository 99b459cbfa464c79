#pragma once
// What of a weighted site's side of a curve keeps a distance from the curve.

#include "voronoi2d/clipping/loops.h"
#include "voronoi2d/diagram/bisector.h"

namespace saddleback::voronoi2d {

/// Outlines, counter-clockwise, the points on the left of a bisector that are as far as a distance from it or farther,
/// of those within a radius about a center; beyond, where the outline is closed, it means nothing. Each point of the
/// curve of such points is within a tolerance of the outline; one finer than 2^-40 of the radius is taken as that.
/// Empty where no point within the radius is as far. O(log of the radius over the tolerance), and O(points).
Loop inset_outline(const Bisector& curve, double distance, double tolerance, const Vec2& center, double radius);

}  // namespace saddleback::voronoi2d
