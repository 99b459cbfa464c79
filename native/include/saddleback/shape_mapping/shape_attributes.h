#pragma once
// Attributes of the surface's vertices by the shapes that lie on it.

#include "saddleback/shape_mapping/map_shapes.h"

namespace saddleback {

struct ShapeAttributes {
  std::vector<Index> placement;  ///< (V,) whose shape is the nearest; k_none where none is within reach
  std::vector<double> distance;  ///< (V,) to its outline along the surface, mesh units: negative inside, else infinite
  std::vector<Vec2> plane;       ///< (V,) the vertex in the plane of that shape, in its own units
};

/// Signed distances, as in the plane of each shape, of all vertices inside shapes and of those within `reach` of one.
/// Shapes that cannot be laid have no part in it. \throw InputError as map_shapes does, and for a reach that is
/// negative or not finite; Cancelled. As map_shapes, and O(c) for each vertex near a shape of c corners.
ShapeAttributes shape_attributes(const Mesh& mesh, std::span<const Shape> shapes, std::span<const Placement> placements,
                                 double reach, const MapShapesOptions& options = {});

}  // namespace saddleback
