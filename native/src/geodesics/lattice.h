#pragma once
// Meshes whose vertices all have the same surroundings, as subdivided planes and cylinders have.

#include "saddleback/job.h"

#include "geodesics/unfolding.h"

namespace saddleback {

/// Whether part of the mesh is a lattice: most edges of its vertices go straight on at the next vertex, where the
/// surface is flat. Looks at a sample of the vertices. O(1). \throw Cancelled.
bool has_lattice(const Unfolding& unfolding, const JobStage& stage);

}  // namespace saddleback
