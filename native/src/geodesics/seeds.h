#pragma once
// From points of the surface to vertices of the graph.

#include <vector>

#include "geodesics/graph_search.h"

namespace saddleback {

/// Sources that are vertices are seeds themselves; others get the vertices of their fan (see SaddleVertexGraph::fan).
/// \throw InputError for no sources and points off the mesh; Cancelled.
std::vector<Seed> make_seeds(const SaddleVertexGraph& graph, const SurfacePoints& sources, const JobStage& stage);

}  // namespace saddleback
