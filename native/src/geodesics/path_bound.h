#pragma once
// How long a shortest path can be.

#include <span>

#include "saddleback/job.h"
#include "saddleback/mesh.h"

#include "geodesics/wave_mesh.h"

namespace saddleback {

/// An upper bound of every finite geodesic distance on the mesh, and rarely more than a few times the longest. It does
/// not depend on the threads. O(V). \throw Cancelled.
double longest_path_bound(const WaveMesh& mesh, int threads, const JobStage& stage);
/// The same number where there are no such tables. `nodes` of the vertices and `vertices` of the nodes.
double longest_path_bound(const Mesh& mesh, std::span<const Index> nodes, std::span<const Index> vertices, int threads,
                          const JobStage& stage);

}  // namespace saddleback
