#pragma once
// How long a shortest path can be.

#include "saddleback/mesh.h"

namespace saddleback {

/// An upper bound of every finite geodesic distance on the mesh: twice the longest path of a breadth-first tree, of the
/// worst component. O(V).
double longest_path_bound(const Mesh& mesh);

}  // namespace saddleback
