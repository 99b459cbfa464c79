#include "tessellation/vertex_rings.h"

#include <cmath>

#include "geodesics/unfolding.h"
#include "support/parallel.h"

namespace saddleback {
namespace {

// Less excess of angle than this bends wavefronts so little (its square an eighth, relative to the distance) that what
// lies behind the vertex may be seen across edges as if straight.
constexpr double k_flat_excess = 0.1;

/// Visits the half-edges out of a vertex, counter-clockwise.
template <class Visit>
void for_each_out(const Mesh& mesh, Index vertex, Visit&& visit) {
  const Index first = mesh.first_halfedge(vertex);
  for (Index h = first; h != k_none;) {
    visit(h);
    h = mesh.rotate(h);
    if (h == first) h = k_none;
  }
}

}  // namespace

bool VertexRings::bends_much(const Mesh& mesh, Index vertex) {
  return mesh.total_angle(vertex) > (mesh.is_boundary(vertex) ? M_PI : 2 * M_PI) + k_flat_excess;
}

VertexRings::VertexRings(const SaddleVertexGraph& graph, int threads) : first_(graph.mesh().vertex_count() + 1, 0) {
  const Mesh& mesh = graph.mesh();
  for (const Triangle& t : mesh.triangles()) {
    for (const Index v : t) ++first_[graph.node_of(v) + 1];
  }
  for (Index node = 0; node < mesh.vertex_count(); ++node) first_[node + 1] += first_[node];
  wedges_.resize(first_.back());
  parallel_for(mesh.vertex_count(), threads, 1024, [&](Index node, int) {
    Wedge* wedge = &wedges_[first_[node]];
    for_each_out(mesh, graph.vertex_of(node), [&](Index h) {
      const Index edge = Mesh::next(h), a = mesh.from(edge), b = mesh.to(edge);
      *wedge++ = {graph.node_of(a),
                  graph.node_of(b),
                  edge,
                  bends_much(mesh, a),
                  bends_much(mesh, b),
                  mesh.length(edge),
                  graph.unfolding().apex(edge)};
    });
  });
}

}  // namespace saddleback
