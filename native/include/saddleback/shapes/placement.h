#pragma once
// The place of a shape on a surface.

#include <span>
#include <vector>

#include "saddleback/mesh/surface_points.h"

namespace saddleback {

/// One copy of a shape. A point (x, y) of the shape's plane is laid at the distance scale * |(x, y)| from the center,
/// in the direction `angle` + atan2(y, x).
struct Placement {
  Index shape = 0;  ///< which of a list of shapes
  SurfacePoint center;
  /// Direction of the shape's x axis in the FaceChart of center.face: from its first edge, counter-clockwise, radians.
  double angle = 0;
  double scale = 1;       ///< mesh units for one unit of the shape's plane, > 0
  bool mirrored = false;  ///< y of the shape's plane is negated first
};

using Placements = std::vector<Placement>;

/// \throw InputError naming the first placement with a shape out of range, a center off the mesh, an angle that is not
/// finite or a scale that is not positive and finite.
void check_placements(const Mesh& mesh, std::size_t shape_count, std::span<const Placement> placements);

}  // namespace saddleback
