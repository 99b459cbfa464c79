#pragma once
// Chains of straight pieces as polylines.

#include "saddleback/mesh/trace.h"

#include "geodesics/unfolding/path_shortening.h"

namespace saddleback {

/// Appends a chain's points, one for each edge or vertex that it crosses. Edges that meet at a vertex of the chain are
/// crossed there, in one point.
void append_points(const Mesh& mesh, const LegChain& chain, std::vector<Vec3>& points, SurfacePoints& surface);

}  // namespace saddleback
