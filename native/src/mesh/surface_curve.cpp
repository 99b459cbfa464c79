#include "saddleback/mesh/surface_curve.h"

#include <algorithm>
#include <limits>

#include "saddleback/error.h"

#include "mesh/tables/outgoing.h"

namespace saddleback {
namespace {

// Relative to the face's edges: a shorter step between two points is rounding and has no direction.
constexpr double k_no_length = 1e-14;

int corner_of(const Mesh& mesh, Index face, Index vertex) {
  const Triangle& t = mesh.triangles()[face];
  return vertex == t[0] ? 0 : vertex == t[1] ? 1 : vertex == t[2] ? 2 : -1;
}

/// Calls `visit` for every face that the point lies on until it returns true.
template <class Visit>
bool any_face_of(const Mesh& mesh, const SurfacePoint& point, double tolerance, Visit&& visit) {
  if (visit(point.face)) return true;
  for (int i = 0; i < 3; ++i) {
    const Index h = 3 * point.face + i;
    const bool on_edge = point.barycentric[(i + 2) % 3] <= tolerance;
    if (on_edge && mesh.twin(h) != k_none && visit(Mesh::face_of(mesh.twin(h)))) return true;
    if (point.barycentric[i] < 1 - 2 * tolerance) continue;
    for (const Index g : outgoing(mesh, mesh.from(h)))
      if (visit(Mesh::face_of(g))) return true;
  }
  return false;
}

}  // namespace

std::optional<Vec3> barycentric_in(const Mesh& mesh, const SurfacePoint& point, Index face, double tolerance) {
  if (face == point.face) return point.barycentric;
  Vec3 result = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    const int corner = corner_of(mesh, face, mesh.triangles()[point.face][i]);
    if (corner >= 0) {
      result[corner] = point.barycentric[i];
    } else if (point.barycentric[i] > tolerance) {
      return std::nullopt;
    }
  }
  // Two faces share at most an edge: a point inside its own face has no coordinates in another.
  if (result.minCoeff() > 0) return std::nullopt;
  return result / result.sum();
}

Index shared_face(const Mesh& mesh, const SurfacePoint& a, const SurfacePoint& b, double tolerance) {
  if (tolerance > 0)  // a tolerated face would move a point that lies beside an edge onto it
    if (const Index face = shared_face(mesh, a, b, 0); face != k_none) return face;
  if (barycentric_in(mesh, b, a.face, tolerance)) return a.face;
  if (barycentric_in(mesh, a, b.face, tolerance)) return b.face;
  Index found = k_none;
  any_face_of(mesh, a, tolerance, [&](Index face) {
    if (!barycentric_in(mesh, b, face, tolerance)) return false;
    found = face;
    return true;
  });
  return found;
}

double step_length(const Mesh& mesh, const SurfacePoint& a, const SurfacePoint& b) {
  if (!mesh.is_intrinsic()) return (position(mesh, b) - position(mesh, a)).norm();
  const Index face = shared_face(mesh, a, b, k_barycentric_tolerance);
  if (face == k_none) return std::numeric_limits<double>::infinity();
  const FaceChart chart(mesh, face);
  return (chart.to_plane(*barycentric_in(mesh, b, face, k_barycentric_tolerance)) -
          chart.to_plane(*barycentric_in(mesh, a, face, k_barycentric_tolerance)))
      .norm();
}

SurfaceCurve::SurfaceCurve(const Mesh& mesh, SurfacePoints points, bool closed, const char* argument)
    : mesh_(&mesh), points_(std::move(points)), closed_(closed) {
  check_surface_points(mesh, points_, argument);
  if (points_.size() < 2) throw InputError(message(argument, ": wanted at least two points, got ", points_.size()));
  for (SurfacePoint& point : points_) point.barycentric = normalized_barycentric(point.barycentric);
  segments_.reserve(points_.size());
  for (std::size_t i = 0; i + 1 < points_.size(); ++i) add_segment(i, i + 1, argument);
  if (closed_) add_segment(points_.size() - 1, 0, argument);
  if (segments_.empty())
    throw InputError(message(argument, ": all are the same point, so that the curve has no length"));
}

void SurfaceCurve::add_segment(std::size_t from, std::size_t to, const char* argument) {
  const SurfacePoint &a = points_[from], &b = points_[to];
  const Index face = shared_face(*mesh_, a, b, k_barycentric_tolerance);
  if (face == k_none) {
    throw InputError(message(argument, ": points ", from, " (face ", a.face, ") and ", to, " (face ", b.face,
                             ") share no face; a curve crosses an edge or vertex at a point of its own"));
  }
  CurveSegment segment{face, *barycentric_in(*mesh_, a, face, k_barycentric_tolerance),
                       *barycentric_in(*mesh_, b, face, k_barycentric_tolerance), length_, 0};
  // By what the coordinates differ: places far from the origin are rounded, and one place would be two. Seen from where
  // they differ most no more is added than remains, also along a needle's short side.
  const Vec3 change = segment.end - segment.begin;
  const std::array<Vec3, 3> corner = mesh_->corners(3 * face);
  Index most = 0;
  change.cwiseAbs().maxCoeff(&most);
  const auto leads = [&](Index i) { return Vec3(change[i] * (corner[i] - corner[most])); };
  segment.length = (leads((most + 1) % 3) + leads((most + 2) % 3)).norm();
  const Index h = 3 * face;
  const double longest = std::max({mesh_->length(h), mesh_->length(h + 1), mesh_->length(h + 2)});
  if (segment.length <= k_no_length * longest) return;
  length_ += segment.length;
  segments_.push_back(segment);
}

}  // namespace saddleback
