#pragma once
// Fewer corners for outlines, at the expense of what lies outside.

#include <vector>

#include "saddleback/shapes/shape.h"

namespace saddleback::distribution {

/// Takes corners away, those first that add least area, until there are at most max_corners and every further one would
/// add more than `free_area`: corners that turn outwards are cut off, edges between corners that turn inwards are
/// replaced by the continuation of their neighbors, small holes are filled. Loops have the inside on their left; they
/// stay simple and apart, and what they enclose only grows. May end with more corners where nothing can be taken away.
/// O(m^2) for m corners.
void simplify_outward(std::vector<Shape::Loop>& loops, Index max_corners, double free_area, const JobStage& stage = {});

}  // namespace saddleback::distribution
