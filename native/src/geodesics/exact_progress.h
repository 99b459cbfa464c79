#pragma once
// How the time of a propagation of exact distances is spread.

#include "geodesics/distance_progress.h"

namespace saddleback {

/// Of the time of a propagation that is watched, what passes before it runs: its surface is laid out.
double share_of_surface(const Mesh& mesh, std::size_t source_count, double limit);

/// Of the propagation itself; the guess is a part of the stage. \throw Cancelled.
DistanceProgress exact_progress(const Mesh& mesh, const SurfacePoints& sources, double limit, const JobStage& stage);

}  // namespace saddleback
