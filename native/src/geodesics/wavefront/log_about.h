#pragma once
// The logarithmic map as a part of other work.

#include "saddleback/geodesics/log_map.h"

#include "geodesics/wavefront/query_points.h"

namespace saddleback {

/// log_map of a good point, and beside it of `places`, if any: what WavefrontDistances finds of them. \throw Cancelled.
LogMap log_about(const SaddleVertexGraph& graph, const SurfacePoint& center, double radius, const WatchedPlaces* places,
                 PlaceDistances& found, const JobStage& stage);

}  // namespace saddleback
