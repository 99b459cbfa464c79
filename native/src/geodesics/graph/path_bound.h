#pragma once
// Bounds on the length of a shortest path, and on that of the shortest edge.

#include <span>

#include "saddleback/job.h"
#include "saddleback/mesh/mesh.h"

#include "geodesics/graph/arc_rows.h"
#include "geodesics/graph/window_mesh.h"

namespace saddleback {

/// An upper bound of every finite geodesic distance on the mesh, rarely more than a few times the longest, and the
/// length of the shortest edge. They do not depend on the threads. O(V). \throw Cancelled.
PathBounds path_bounds(const WindowMesh& mesh, int threads, const JobStage& stage);
/// Returns the same numbers where there are no such tables. `nodes` of the vertices and `vertices` of the nodes.
PathBounds path_bounds(const Mesh& mesh, std::span<const Index> nodes, std::span<const Index> vertices, int threads,
                       const JobStage& stage);

}  // namespace saddleback
