#pragma once
// Many shapes laid on a surface at once.

#include "saddleback/job.h"
#include "saddleback/shape_mapping/surface_outline.h"
#include "saddleback/shapes/shape.h"

namespace saddleback {

struct MapShapesOptions {
  MapLimits limits;
  const DirectionField* field = nullptr;  ///< shapes bend along its curves; null: by the exponential map
  int threads = 0;                        ///< 0: all cores; never changes the result
  Job* job = nullptr;
};

struct MappedShape {
  MapFailure failure = MapFailure::none;
  SurfaceOutline outline;  ///< empty when there is a failure
};

/// Lays one shape. Along the field where one is given and has a direction at the center.
MapFailure map_shape(OutlineMapper& mapper, const Shape& shape, const Placement& placement, const DirectionField* field,
                     SurfaceOutline& outline, const MapLimits& limits = {});

/// Lays a shape for each placement. \throw InputError for what check_placements refuses, a field of another mesh,
/// limits that are not positive or in the wrong order; Cancelled. Time as OutlineMapper::map for each.
std::vector<MappedShape> map_shapes(const Mesh& mesh, std::span<const Shape> shapes,
                                    std::span<const Placement> placements, const MapShapesOptions& options = {});

}  // namespace saddleback
