#pragma once
// Ways along edges: a first guess of distances, which takes little time.

#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh/surface_points.h"

namespace saddleback {

/// Straight lines are this much shorter than ways along the edges of common meshes.
inline constexpr double k_straighter = 0.92;

/// Calls visit(neighbor, half-edge of their edge) for the neighbors of a vertex.
template <class Visit>
void for_neighbors(const Mesh& mesh, Index vertex, Visit&& visit) {
  const Index first = mesh.first_halfedge(vertex);
  Index h = first;
  do {
    visit(mesh.to(h), h);
    const Index last = Mesh::prev(h);
    if (mesh.twin(last) == k_none) visit(mesh.from(last), last);
    h = mesh.rotate(h);
  } while (h != k_none && h != first);
}

/// Lengths of ways along edges from the nearest source, nearly the shortest ones. \return infinity for vertices beyond
/// the limit. \throw Cancelled. O(V).
std::vector<double> ways_along_edges(const Mesh& mesh, const SurfacePoints& sources, double limit,
                                     const JobStage& stage);

}  // namespace saddleback
