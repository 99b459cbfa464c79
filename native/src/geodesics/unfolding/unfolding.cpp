#include "geodesics/unfolding/unfolding.h"

#include "geodesics/unfolding/unfolded_corner.h"
#include "mesh/tables/outgoing.h"
#include "support/threads/parallel.h"

namespace saddleback {
// The difference of the squares of two lengths is off by a rounding of the longest edge's square, so that the direction
// of a short edge would be off by the longest over that edge: a cone that comes through it was turned by as much.
// Differences of positions keep all digits.
UnfoldedFace unfold(const Mesh& mesh, Index h) {
  const double base = mesh.length(h), left = mesh.length(Mesh::prev(h)), right = mesh.length(Mesh::next(h));
  const double off = corner_off(base, mesh.face_area(Mesh::face_of(h)));
  if (!is_needle(base, left, right)) {
    const double along = corner_along(base, left, right);
    return {{along, off}, base - along};
  }
  const auto [from, to, apex] = mesh.corners(h);
  return {{(to - from).dot(apex - from) / base, off}, (from - to).dot(apex - to) / base};
}

Unfolding::Unfolding(const Mesh& mesh, int threads, const JobStage& stage)
    : mesh_(&mesh), apexes_(mesh.halfedge_count()), polars_(mesh.halfedge_count()) {
  parallel_for(mesh.halfedge_count(), threads, 4096, [&](Index h, int) {
    stage.check();
    apexes_[h] = unfold(mesh, h).apex;
  });
  parallel_for(mesh.vertex_count(), threads, 1024, [&](Index v, int) {
    stage.check();
    double angle = 0;
    for (const Index h : outgoing(mesh, v)) {
      polars_[h] = angle;
      angle += mesh.corner_angle(h);
    }
  });
}

double Unfolding::sum_to(Index h) const {
  double angle = 0;
  for (Index other = mesh_->first_halfedge(mesh_->from(h)); other != h; other = mesh_->rotate(other))
    angle += mesh_->corner_angle(other);
  return angle;
}

}  // namespace saddleback
