#pragma once
// Many shapes laid on a surface at once.

#include "saddleback/field/direction_field.h"
#include "saddleback/job.h"
#include "saddleback/shape_mapping/surface_outline.h"
#include "saddleback/shapes/placement.h"
#include "saddleback/shapes/shape.h"
#include "saddleback/support/one_or_each.h"

namespace saddleback {

struct MapShapesOptions {
  MapLimits limits;
  /// Shapes bend along its curves: one for all shapes, or one a shape; empty: by the exponential map.
  std::vector<const DirectionField*> fields;
  int threads = 0;  ///< 0: all cores; never changes the result
  Job* job = nullptr;

  const DirectionField* field(Index shape) const { return fields.empty() ? nullptr : one_or_each(fields, shape); }
};

struct MappedShape {
  MapFailure failure = MapFailure::none;
  SurfaceOutline outline;  ///< empty when there is a failure
};

/// Lays a shape for each placement. \throw InputError for what check_placements refuses, a field of another mesh,
/// fields of another number than shapes, limits that are not positive or in the wrong order; Cancelled. O(n log n + c
/// m) each, for n vertices within the box of a shape, c corners and m vertices in or about it.
std::vector<MappedShape> map_shapes(const Mesh& mesh, std::span<const Shape> shapes,
                                    std::span<const Placement> placements, const MapShapesOptions& options = {});

}  // namespace saddleback
