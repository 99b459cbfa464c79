#include "mesh/tables/halfedges.h"

#include "saddleback/mesh/mesh.h"

#include "mesh/tables/edge_table.h"

namespace saddleback {

void fill_halfedges(OpenMesh::TriConnectivity& mesh, std::span<const Triangle> triangles, Index vertex_count) {
  using OpenMesh::FaceHandle, OpenMesh::HalfedgeHandle, OpenMesh::VertexHandle;
  const EdgeTable edges = build_edge_table(triangles, vertex_count);
  const Index face_count = static_cast<Index>(triangles.size());
  mesh.clear();
  mesh.reserve(static_cast<std::size_t>(vertex_count), static_cast<std::size_t>(edges.edge_count()), triangles.size());
  for (Index v = 0; v < vertex_count; ++v) mesh.new_vertex();
  for (Index f = 0; f < face_count; ++f) mesh.new_face();

  std::vector<HalfedgeHandle> handles(3 * triangles.size());
  std::vector<HalfedgeHandle> boundary_into(vertex_count);  // the face's half-edge that ends there on the boundary
  for (Index e = 0; e < edges.edge_count(); ++e) {
    const std::span<const Index> around = edges.edge(e);
    const VertexHandle a(halfedge_from(triangles, around[0])), b(halfedge_to(triangles, around[0]));
    handles[around[0]] = mesh.new_edge(a, b);
    if (around.size() == 2) {
      handles[around[1]] = mesh.opposite_halfedge_handle(handles[around[0]]);
    } else {
      boundary_into[b.idx()] = handles[around[0]];
    }
  }
  for (Index h = 0; h < 3 * face_count; ++h) {
    mesh.set_face_handle(handles[h], FaceHandle(h / 3));
    mesh.set_next_halfedge_handle(handles[h], handles[Mesh::next(h)]);
    mesh.set_halfedge_handle(VertexHandle(halfedge_from(triangles, h)), handles[h]);
    if (h % 3 == 0) mesh.set_halfedge_handle(FaceHandle(h / 3), handles[h]);
  }
  for (const HalfedgeHandle into : boundary_into) {
    if (!into.is_valid()) continue;
    const HalfedgeHandle outside = mesh.opposite_halfedge_handle(into);  // from where `into` ends to where it starts
    const HalfedgeHandle before = boundary_into[mesh.to_vertex_handle(outside).idx()];
    mesh.set_next_halfedge_handle(outside, mesh.opposite_halfedge_handle(before));
    mesh.set_halfedge_handle(mesh.to_vertex_handle(into),
                             outside);  // OpenMesh wants a boundary vertex to start outside
  }
  mesh.request_vertex_status();
  mesh.request_edge_status();
  mesh.request_halfedge_status();
  mesh.request_face_status();
}

}  // namespace saddleback
