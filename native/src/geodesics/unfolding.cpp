#include "geodesics/unfolding.h"

namespace saddleback {

Unfolding::Unfolding(const Mesh& mesh) : mesh_(&mesh), apexes_(mesh.halfedge_count()), polars_(mesh.halfedge_count()) {
  for (Index h = 0; h < mesh.halfedge_count(); ++h) {
    const double base = mesh.length(h), left = mesh.length(Mesh::prev(h)), right = mesh.length(Mesh::next(h));
    // x from the lengths, factored against cancellation on needles; y from the area, which the mesh computes stably.
    const double x = (base + (left - right) * ((left + right) / base)) / 2;
    apexes_[h] = {x, 2 * mesh.face_area(Mesh::face_of(h)) / base};
  }
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const Index first = mesh.first_halfedge(v);
    double angle = 0;
    Index h = first;
    do {
      polars_[h] = angle;
      angle += mesh.corner_angle(h);
      h = mesh.rotate(h);
    } while (h != k_none && h != first);
  }
}

}  // namespace saddleback
