#pragma once
// The graph's own numbering of the vertices.

#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh/mesh.h"

namespace saddleback {

/// Vertices along a curve that fills space: neighbors lie close in memory.
struct NodeOrder {
  std::vector<Index> vertices, nodes;  ///< of the nodes; of the vertices
  /// \throw Cancelled. O(V).
  NodeOrder(const Mesh& mesh, int threads, const JobStage& stage);
};

}  // namespace saddleback
