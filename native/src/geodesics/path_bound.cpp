#include "geodesics/path_bound.h"

#include <algorithm>

namespace saddleback {

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
