#pragma once
// Lengths of ways along edges: never shorter than distances on the surface, longer by a tenth or two.

#include <span>
#include <vector>

#include "saddleback/mesh/mesh.h"

namespace saddleback::distribution {

/// Per vertex the shortest way from any source; infinite beyond `limit`. Dijkstra's algorithm, O(V log V).
std::vector<double> edge_distances(const Mesh& mesh, std::span<const Index> sources, double limit);

/// Per vertex how far a front has come, 0 to 1, that sets out in each component from one end of it.
std::vector<double> sweep_coordinate(const Mesh& mesh);

}  // namespace saddleback::distribution
