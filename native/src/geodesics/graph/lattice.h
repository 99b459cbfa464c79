#pragma once
// Meshes whose vertices all have the same surroundings, as subdivided planes and cylinders have, and straight strips.

#include "saddleback/job.h"

#include "geodesics/unfolding/unfolding.h"

namespace saddleback {

enum class Lattice {
  none,
  even,       ///< of cells about as long as wide
  stretched,  ///< of longer ones
};

/// Returns what lattice part of the mesh is, the more stretched one of several: most edges of its vertices go straight
/// on at the next vertex, where the surface is flat; or its vertices are on the border of a flat strip one cell wide.
/// Looks at a sample of the vertices. O(1). \throw Cancelled.
Lattice lattice_of(const Unfolding& unfolding, int threads, const JobStage& stage);

}  // namespace saddleback
