#include "field/connection/filled_surface.h"

#include <numbers>

#include "saddleback/error.h"

namespace saddleback {

FilledSurface::FilledSurface(const Mesh& mesh)
    : node_of(mesh.vertex_count(), k_none), components(mesh.component_count()) {
  constexpr double k_pi = std::numbers::pi;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (mesh.is_boundary(v)) continue;
    node_of[v] = node_count++;
    curvature.push_back(2 * k_pi - mesh.total_angle(v));
    component_of.push_back(mesh.component_of(v));
  }
  for (const std::vector<Index>& loop : mesh.boundary_loops()) {
    double total = 2 * k_pi;
    for (const Index v : loop) {
      node_of[v] = node_count;
      total += k_pi - mesh.total_angle(v);
    }
    const Index component = mesh.component_of(loop.front());
    components[component].loops.push_back(static_cast<Index>(loop_nodes.size()));
    loop_nodes.push_back(node_count++);
    curvature.push_back(total);
    component_of.push_back(component);
  }
  // nodes - edges + faces = 2 - 2 genus
  std::vector<Index> euler(components.size(), 0);
  for (const Index c : component_of) ++euler[c];
  for (Index f = 0; f < mesh.face_count(); ++f) ++euler[mesh.component_of(mesh.triangles()[f][0])];
  for (const Index h : inner_edges(mesh)) --euler[mesh.component_of(mesh.from(h))];
  for (std::size_t c = 0; c < components.size(); ++c) components[c].genus = (2 - euler[c]) / 2;
}

std::string FilledSurface::name(Index component) const {
  const auto loops = components[component].loops.size();
  return message("component ", component, " (genus ", components[component].genus, ", ", loops,
                 loops == 1 ? " boundary loop)" : " boundary loops)");
}

std::vector<Index> inner_edges(const Mesh& mesh) {
  std::vector<Index> result;
  result.reserve(mesh.edge_count());
  for (Index h = 0; h < mesh.halfedge_count(); ++h)
    if (mesh.twin(h) > h) result.push_back(h);
  return result;
}

}  // namespace saddleback
