#pragma once
// The outlines along which an image passes one half.

#include <vector>

#include "saddleback/job.h"
#include "saddleback/shapes/shape.h"

namespace saddleback::distribution {

/// Closed outlines with the inside on their left, in pixels: pixel centers at (column, -row), zeros around the image.
/// No two touch. Marching squares, after [lorensen1987]. O(pixels).
std::vector<Shape::Loop> mask_outlines(const MaskImage& image, const JobStage& stage = {});

/// Every hole with the smallest outline around it. O(loops^2 corners).
std::vector<Shape::Part> parts_of(std::vector<Shape::Loop> loops, const JobStage& stage = {});

}  // namespace saddleback::distribution
