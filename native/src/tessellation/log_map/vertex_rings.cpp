#include "tessellation/log_map/vertex_rings.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geodesics/unfolding/unfolding.h"
#include "mesh/tables/outgoing.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

// Less excess of angle than this bends wavefronts so little (its square an eighth, relative to the distance) that what
// lies behind the vertex may be seen across edges as if straight.
constexpr double k_flat_excess = 0.1;

}  // namespace

bool VertexRings::bends_much(const Mesh& mesh, Index vertex) {
  return mesh.total_angle(vertex) >
         (mesh.is_boundary(vertex) ? std::numbers::pi : 2 * std::numbers::pi) + k_flat_excess;
}

VertexRings::VertexRings(const SaddleVertexGraph& graph, int threads) : first_(graph.mesh().vertex_count() + 1, 0) {
  const Mesh& mesh = graph.mesh();
  const auto count_wedges = [&] {
    for (const Triangle& t : mesh.triangles()) {
      for (const Index v : t) ++first_[graph.node_of(v) + 1];
    }
    for (Index node = 0; node < mesh.vertex_count(); ++node) first_[node + 1] += first_[node];
  };
  parallel_for(2, threads, 1, [&](Index task, int) { task == 0 ? order_faces(graph, threads) : count_wedges(); });
  wedges_.resize(first_.back());
  parallel_for(mesh.vertex_count(), threads, 1024, [&](Index node, int) {
    Wedge* wedge = &wedges_[first_[node]];
    for (const Index h : outgoing(mesh, graph.vertex_of(node))) {
      const Index edge = Mesh::next(h), a = mesh.from(edge), b = mesh.to(edge);
      *wedge++ = {graph.node_of(a),
                  graph.node_of(b),
                  3 * places_[Mesh::face_of(edge)] + edge % 3,
                  bends_much(mesh, a),
                  bends_much(mesh, b),
                  mesh.length(edge),
                  graph.unfolding().apex(edge)};
    }
  });
}

/// Orders the faces by their first node.
void VertexRings::order_faces(const SaddleVertexGraph& graph, int threads) {
  const Mesh& mesh = graph.mesh();
  const auto first_node = [&](Index face) {
    const Triangle& t = mesh.triangles()[face];
    return std::min({graph.node_of(t[0]), graph.node_of(t[1]), graph.node_of(t[2])});
  };
  std::vector<Index> cursor(mesh.vertex_count() + 1, 0);
  for (Index face = 0; face < mesh.face_count(); ++face) ++cursor[first_node(face) + 1];
  for (Index node = 0; node < mesh.vertex_count(); ++node) cursor[node + 1] += cursor[node];
  places_.resize(mesh.face_count());
  for (Index face = 0; face < mesh.face_count(); ++face) places_[face] = cursor[first_node(face)]++;
  faces_.resize(mesh.face_count());
  parallel_for(mesh.face_count(), threads, 4096, [&](Index face, int) {
    Face& placed = faces_[places_[face]];
    placed.in_mesh = face;
    for (int i = 0; i < 3; ++i) {
      const Index twin = mesh.twin(3 * face + i);
      placed.nodes[i] = graph.node_of(mesh.triangles()[face][i]);
      placed.twins[i] = twin == k_none ? k_none : 3 * places_[Mesh::face_of(twin)] + twin % 3;
    }
  });
}

}  // namespace saddleback
