#pragma once
// The logarithmic map as a part of other work.

#include "saddleback/geodesics/log_map.h"

#include "geodesics/wavefront/directions_at_point.h"
#include "geodesics/wavefront/query_points.h"

namespace saddleback {

/// The center of a map: a vertex where it is as good as one.
SurfacePoint center_of_map(const SurfacePoint& given);

/// Sends rays from a center all round, as far as `radius`. \throw Cancelled.
void send_rays_about(WavefrontDistances& field, const DirectionsAtPoint& center, double radius,
                     const WatchedPlaces* places, const JobStage& stage, const ReportRays& report = {});

/// log_map of a good point, and beside it of `places`, if any: what WavefrontDistances finds of them. \throw Cancelled.
LogMap log_about(const SaddleVertexGraph& graph, const SurfacePoint& center, double radius, const WatchedPlaces* places,
                 PlaceDistances& found, const JobStage& stage);

}  // namespace saddleback
