#pragma once
// The logarithmic map as a part of other work.

#include "saddleback/polar_coordinates.h"

#include "geodesics/watched_places.h"

namespace saddleback {

/// log_map of a good point, and beside it of `places`, if any: what RayField finds of them. \throw Cancelled.
LogMap log_about(const SaddleVertexGraph& graph, const SurfacePoint& centre, double radius, const WatchedPlaces* places,
                 PlaceDistances& found, const JobStage& stage);

}  // namespace saddleback
