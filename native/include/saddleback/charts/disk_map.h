#pragma once
// Flat maps of disk-like surfaces.

#include <vector>

#include "saddleback/mesh/mesh.h"
#include "saddleback/types.h"

namespace saddleback {

/// (V) places of the vertices in the unit disk: the border goes once around the circle, in proportion to its edges'
/// lengths, and every inner vertex lies at the weighted mean of its neighbors. Weights are cotangents (the discrete
/// harmonic map of [pinkall1993]), raised to a small positive number where the triangulation is not Delaunay, so that
/// no face flips [tutte1963], [floater2003]. That is checked exactly for every face.
/// \throw InputError for a mesh that is not a disk (one part, one border, no handles) and for one so long or so deep
/// that faces vanish in the rounding of doubles, naming the first; Cancelled.
/// O(V log V) memory, O(V^1.5) time.
std::vector<Vec2> harmonic_map(const Mesh& mesh, Job* job = nullptr);

}  // namespace saddleback
