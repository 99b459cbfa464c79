#include "geodesics/unfolding/line_of_sight.h"

#include <algorithm>
#include <utility>

#include "saddleback/mesh/surface_curve.h"

#include "support/planar.h"

namespace saddleback {
namespace {

// A ray this close to a window's border (relative to the distance) runs along it.
constexpr double k_on_border = 1e-12;
// Room for rounding where paths are refused for being too long.
constexpr double k_too_long = 1 + 1e-9;

bool comes_first(const SurfacePoint& a, const SurfacePoint& b) {
  if (a.face != b.face) return a.face < b.face;
  return std::lexicographical_compare(a.barycentric.begin(), a.barycentric.end(), b.barycentric.begin(),
                                      b.barycentric.end());
}

}  // namespace

double LineOfSight::length(const Unfolding& unfolding, const SurfacePoint& a, const SurfacePoint& b, double upper) {
  const Mesh& mesh = unfolding.mesh();
  const bool in_order = comes_first(a, b);
  const SurfacePoint& source = in_order ? a : b;
  const SurfacePoint& target = in_order ? b : a;
  entered_.clear();
  if (const Index face = shared_face(mesh, source, target); face != k_none) {
    const FaceChart chart(mesh, face);
    const Vec2 gap =
        chart.to_plane(*barycentric_in(mesh, source, face)) - chart.to_plane(*barycentric_in(mesh, target, face));
    return std::min(upper, gap.norm());
  }
  const Vec3 goal = position(mesh, target);
  set_out(mesh, source);
  for (int windows = 0; !stack_.empty() && windows < most_windows_; ++windows) {
    const Window window = stack_.back();
    stack_.pop_back();
    const Index h = window.entered;
    const double least = distance_to_segment(Vec2(Vec2::Zero()), window.from, window.to) +
                         mesh.bird(distance_to_segment(goal, mesh.position(mesh.from(h)), mesh.position(mesh.to(h))));
    if (least > upper * k_too_long) continue;
    trail_.resize(window.depth);
    trail_.push_back(h);
    const Vec2 along = (window.to - window.from) / mesh.length(h);
    const Vec2& offset = unfolding.apex(h);
    const Vec2 apex = window.from + offset.x() * along + offset.y() * Vec2(-along.y(), along.x());
    if (Mesh::face_of(h) == target.face) {
      const Vec3& weights = target.barycentric;
      const Vec2 place =
          weights[h % 3] * window.from + weights[Mesh::next(h) % 3] * window.to + weights[Mesh::prev(h) % 3] * apex;
      const double tolerance = k_on_border * place.norm();
      const bool is_seen = cross(window.right, place) >= -tolerance && cross(place, window.left) >= -tolerance;
      if (is_seen && place.norm() < upper) {
        upper = place.norm();
        entered_ = trail_;
      }
    }
    const double reach = apex.norm(), tolerance = k_on_border * reach;
    const double from_right = cross(window.right, apex), to_left = cross(apex, window.left);
    const Vec2 ray = apex / reach;
    if (to_left > -tolerance)
      push(mesh, Mesh::prev(h), window.depth + 1, window.from, apex, from_right > 0 ? ray : window.right, window.left);
    if (from_right > -tolerance)
      push(mesh, Mesh::next(h), window.depth + 1, apex, window.to, window.right, to_left > 0 ? ray : window.left);
  }
  if (!in_order) {
    std::ranges::reverse(entered_);
    for (Index& h : entered_) h = mesh.twin(h);
  }
  return upper;
}

/// Sets out through the three edges of the point's face.
void LineOfSight::set_out(const Mesh& mesh, const SurfacePoint& point) {
  stack_.clear();
  const FaceChart chart(mesh, point.face);
  const Vec2 center = chart.to_plane(point.barycentric);
  for (int corner = 0; corner < 3; ++corner) {
    const Vec2 right = chart.corner[corner] - center, left = chart.corner[(corner + 1) % 3] - center;
    push(mesh, 3 * point.face + corner, 0, left, right, right.normalized(), left.normalized());
  }
}

void LineOfSight::push(const Mesh& mesh, Index edge, Index depth, const Vec2& from, const Vec2& to, const Vec2& right,
                       const Vec2& left) {
  if (const Index entered = mesh.twin(edge); entered != k_none)
    stack_.push_back({entered, depth, from, to, right, left});
}

}  // namespace saddleback
