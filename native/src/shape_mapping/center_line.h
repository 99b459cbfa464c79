#pragma once
// The curve along which a long shape bends.

#include <optional>

#include "saddleback/field/streamline.h"
#include "saddleback/shapes/placement.h"

#include "shape_mapping/shape_map.h"

namespace saddleback {

/// A curve through a placement's center that follows a field.
struct CenterLine {
  SurfaceCurve curve;
  double origin = 0;  ///< arc length of the curve at the center
  double turn = 0;    ///< from the curve to the shape's x axis at the center, radians counter-clockwise
};

/// The field's curve through the center in that of its directions that is nearest to the placement's own, long enough
/// for `box` (of the shape's plane, mesh units). Where the field turns too fast for the box's width the curve lags
/// behind it, so that what is laid along it stays unfolded. None where the field has no direction: at a singular
/// vertex, or on a boundary that it leaves by. \throw InputError as `streamline` does. O(faces crossed).
std::optional<CenterLine> center_line(const DirectionField& field, const Placement& placement, const PlaneBox& box);

/// The box of loops that are scaled and mirrored as a placement says; contains the origin. O(corners).
PlaneBox box_of(std::span<const std::vector<Vec2>> loops, const Placement& placement);

}  // namespace saddleback
