#include "mesh/tables/outgoing.h"

#include "saddleback/error.h"

namespace saddleback {

Index given_edge(const Mesh& mesh, const std::array<Index, 2>& edge, std::size_t number) {
  for (const Index vertex : edge) {
    if (vertex < 0 || vertex >= mesh.vertex_count())
      throw InputError(
          message("edges: wanted vertices from 0 to ", mesh.vertex_count() - 1, ", got ", vertex, " in edge ", number));
  }
  for (const Index h : outgoing(mesh, edge[0])) {
    if (mesh.to(h) == edge[1]) return h;
    if (const Index last = Mesh::prev(h); mesh.from(last) == edge[1]) return last;
  }
  throw InputError(
      message("edges: no edge of the mesh joins vertices ", edge[0], " and ", edge[1], " of edge ", number));
}

}  // namespace saddleback
