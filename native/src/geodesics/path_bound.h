#pragma once
// How long a shortest path can be.

#include "saddleback/job.h"
#include "saddleback/mesh.h"

namespace saddleback {

/// An upper bound of every finite geodesic distance on the mesh: twice the longest path of a breadth-first tree, of the
/// worst component. O(V). \throw Cancelled.
double longest_path_bound(const Mesh& mesh, const JobStage& stage);

}  // namespace saddleback
