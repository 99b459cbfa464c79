#include "geodesics/path_bound.h"

#include <algorithm>

namespace saddleback {
namespace {

// Vertices of the queue whose first half-edge is asked for ahead, and vertices whose faces are: they lie anywhere.
constexpr std::size_t k_vertices_ahead = 16, k_faces_ahead = 8;

}  // namespace

double longest_path_bound(const Mesh& mesh, const JobStage& stage) {
  std::vector<double> depth(mesh.vertex_count(), -1);
  std::vector<Index> queue;
  queue.reserve(mesh.vertex_count());
  double deepest = 0;
  const auto reach = [&](Index vertex, double length) {
    if (depth[vertex] >= 0) return;
    depth[vertex] = length;
    deepest = std::max(deepest, length);
    queue.push_back(vertex);
  };
  std::size_t next = 0;
  for (Index root = 0; root < mesh.vertex_count(); ++root) {
    reach(root, 0);
    for (; next < queue.size(); ++next) {
      stage.check();
      if (next + k_vertices_ahead < queue.size()) {
        const Index ahead = mesh.first_halfedge(queue[next + k_faces_ahead]);
        __builtin_prefetch(&mesh.twins()[ahead]);
        __builtin_prefetch(&mesh.lengths()[ahead]);
        __builtin_prefetch(&mesh.triangles()[Mesh::face_of(ahead)]);
      }
      const Index vertex = queue[next], first = mesh.first_halfedge(vertex);
      Index h = first;
      do {
        reach(mesh.to(h), depth[vertex] + mesh.length(h));
        const Index last = Mesh::prev(h);
        if (mesh.twin(last) == k_none) reach(mesh.from(last), depth[vertex] + mesh.length(last));
        h = mesh.rotate(h);
      } while (h != k_none && h != first);
    }
  }
  return 2 * deepest;
}

}  // namespace saddleback
