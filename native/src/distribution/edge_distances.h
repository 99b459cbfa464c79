#pragma once
// Lengths of ways along edges: never shorter than distances on the surface, longer by a tenth or two.

#include <span>
#include <vector>

#include "saddleback/mesh/mesh.h"

namespace saddleback::distribution {

/// Returns each vertex's distance along edges from the nearest source; infinite beyond `limit`. Dijkstra's algorithm,
/// O(V log V).
std::vector<double> edge_distances(const Mesh& mesh, std::span<const Index> sources, double limit);

/// Returns for each vertex the share (0 to 1) of the way at which a front passes it that sets out from one end of its
/// component.
std::vector<double> sweep_coordinate(const Mesh& mesh);

}  // namespace saddleback::distribution
