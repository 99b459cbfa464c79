#pragma once
// How much a mesh bends cone: what lies behind its vertices is soon dominated by other ways, or late.

#include "saddleback/mesh/mesh.h"

namespace saddleback {

/// Radians that the inner vertices' total angles are off 2 pi, in the mean over some thousand of them: from 0 on flat
/// meshes over some 0.001 on smooth ones to 0.1 on rough scans. O(1).
double mean_angle_defect(const Mesh& mesh);

/// How far windows from a point grow in number with their distance, about: farther out the surface has bent so much of
/// their cone that they meet each other. In edges, and as many windows a vertex.
double edges_until_bent(const Mesh& mesh);

}  // namespace saddleback
