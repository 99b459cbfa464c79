#include "field/connection/dual_loops.h"

#include <algorithm>

#include "support/disjoint_sets.h"

namespace saddleback {
namespace {

std::vector<Index> grow_trees(const Mesh& mesh, DualLoops& result) {
  std::vector<Index> depth(mesh.face_count(), k_none);
  result.entered_by.assign(mesh.face_count(), k_none);
  result.order.reserve(mesh.face_count());
  std::size_t read = 0;
  for (Index root = 0; root < mesh.face_count(); ++root) {
    if (depth[root] != k_none) continue;
    depth[root] = 0;
    result.order.push_back(root);
    for (; read < result.order.size(); ++read) {
      const Index face = result.order[read];
      for (Index h = 3 * face; h < 3 * face + 3; ++h) {
        const Index twin = mesh.twin(h);
        if (twin == k_none || depth[Mesh::face_of(twin)] != k_none) continue;
        depth[Mesh::face_of(twin)] = depth[face] + 1;
        result.entered_by[Mesh::face_of(twin)] = h;
        result.order.push_back(Mesh::face_of(twin));
      }
    }
  }
  return depth;
}

/// Returns the loop that leads across h and back through the tree.
std::vector<Index> loop_through(const Mesh& mesh, const DualLoops& trees, const std::vector<Index>& depth, Index h) {
  std::vector<Index> loop{h}, down;
  Index far = Mesh::face_of(mesh.twin(h)), near = Mesh::face_of(h);
  while (far != near) {
    if (depth[far] >= depth[near]) {
      const Index in = trees.entered_by[far];
      loop.push_back(mesh.twin(in));
      far = Mesh::face_of(in);
    } else {
      down.push_back(trees.entered_by[near]);
      near = Mesh::face_of(trees.entered_by[near]);
    }
  }
  loop.insert(loop.end(), down.rbegin(), down.rend());
  return loop;
}

}  // namespace

DualLoops dual_loops(const Mesh& mesh, const FilledSurface& filled) {
  DualLoops result;
  const std::vector<Index> depth = grow_trees(mesh, result);
  const bool has_handles =
      std::any_of(filled.components.begin(), filled.components.end(), [](const auto& c) { return c.genus > 0; });
  if (!has_handles) return result;
  struct Edge {
    Index length, halfedge;
  };
  std::vector<Edge> edges;
  edges.reserve(mesh.edge_count() - mesh.face_count() + 1);
  for (const Index h : inner_edges(mesh)) {
    const Index f = Mesh::face_of(h), g = Mesh::face_of(mesh.twin(h));
    if (result.entered_by[g] != h && result.entered_by[f] != mesh.twin(h)) edges.push_back({depth[f] + depth[g], h});
  }
  std::stable_sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.length > b.length; });
  DisjointSets forest(filled.node_count);
  for (const Edge& edge : edges) {
    const Index a = filled.node_of[mesh.from(edge.halfedge)], b = filled.node_of[mesh.to(edge.halfedge)];
    if (forest.join(a, b)) continue;
    result.loops.push_back(loop_through(mesh, result, depth, edge.halfedge));
    result.component_of_loop.push_back(filled.component_of[a]);
  }
  return result;
}

}  // namespace saddleback
