#pragma once
// Boundaries of cells that lead to the ends of barriers.

#include "tessellation/polygons/parted_surface.h"

namespace saddleback {

/// Cuts cells that are on both sides of a barrier's end, so that none is.
void cut_to_barrier_ends(PartedSurface& surface);

}  // namespace saddleback
