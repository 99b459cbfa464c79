#include "geodesics/unfolding.h"

#include "geodesics/unfolded_corner.h"
#include "support/parallel.h"

namespace saddleback {

Unfolding::Unfolding(const Mesh& mesh, int threads, const JobStage& stage)
    : mesh_(&mesh), apexes_(mesh.halfedge_count()), polars_(mesh.halfedge_count()) {
  parallel_for(mesh.halfedge_count(), threads, 4096, [&](Index h, int) {
    stage.check();
    const double base = mesh.length(h), left = mesh.length(Mesh::prev(h)), right = mesh.length(Mesh::next(h));
    apexes_[h] = {corner_along(base, left, right), corner_off(base, mesh.face_area(Mesh::face_of(h)))};
  });
  parallel_for(mesh.vertex_count(), threads, 1024, [&](Index v, int) {
    stage.check();
    const Index first = mesh.first_halfedge(v);
    double angle = 0;
    Index h = first;
    do {
      polars_[h] = angle;
      angle += mesh.corner_angle(h);
      h = mesh.rotate(h);
    } while (h != k_none && h != first);
  });
}

}  // namespace saddleback
