#include "tessellation/log_map/edge_sight.h"

#include <algorithm>

#include "geodesics/unfolding/unfolding.h"

namespace saddleback {
namespace {

// Square of the least angle at which an edge must be seen: what lies beyond one seen end-on cannot be told from it.
constexpr double k_end_on = 1e-10;
// The same where only the roundings of the two distances to its ends tell it from one seen end-on, see there.
constexpr double k_end_on_rounded = 1e-8;

// A triangle of the site and an edge whose sides fit this well, relative to the longer ones, is flat but for rounding.
constexpr double k_fits = 1e-11;

}  // namespace

bool fits(const Vec2& from, const Vec2& to, double length) {
  const double excess = (to - from).squaredNorm() - length * length;
  return excess * excess <= 4 * k_fits * k_fits * length * length * std::max(from.squaredNorm(), to.squaredNorm());
}

bool is_straight(const Vec2& at, double distance) { return std::abs(at.norm() - distance) < k_fits * distance; }

bool see(const VertexRings::Wedge& wedge, const VertexPlace& from, const VertexPlace& to, EdgeSight& sight) {
  const double length = wedge.length, square = length * length, side = cross(to.at, from.at);
  // Ends on one ray, as those after one vertex may be, are on one side or the other by rounding alone.
  if (from.anchor != to.anchor || !(side > 0 && side * side > k_end_on * square * square)) return false;
  const double a = from.at.squaredNorm(), b = to.at.squaredNorm();
  // The edge runs along the x axis, the corner above, the anchor below.
  const double x = (a - b + length * length) / (2 * length), y = a - x * x;
  // Distances that are wrong by e, relative, move x by 2 e a / length and y by 2 x times that: no more than
  // 2 e a (a + square) / square.
  if (!(y > k_end_on * square && y * square > k_end_on_rounded * a * (a + square))) return false;
  sight.anchor = Vec2(x, -std::sqrt(y));
  sight.ray = wedge.apex - sight.anchor;
  const double at_edge = x - sight.ray.x() * sight.anchor.y() / sight.ray.y();
  const double miss = at_edge < 0 ? at_edge / length : std::max(0.0, at_edge / length - 1);
  sight.beyond = std::abs(miss) > k_hit ? miss : 0;
  sight.distance = sight.ray.norm();
  sight.is_flat = sight.beyond == 0 && fits(from.at, to.at, length);
  return sight.beyond == 0 || !(sight.beyond < 0 ? wedge.from_bends : wedge.to_bends);
}

std::optional<double> line_across(const Unfolding& unfolding, Index halfedge, const Vec2& corner, const Vec2& goal,
                                  const LegEnd& end) {
  constexpr double k_same_place = 1e-9;  // of the length
  const Mesh& mesh = unfolding.mesh();
  const double tolerance = k_same_place * (goal - corner).norm();
  Vec2 from(mesh.length(halfedge), 0), to = Vec2::Zero();
  Index h = mesh.twin(halfedge);
  for (Index faces = mesh.face_count(); h != k_none && faces > 0; --faces) {
    const Vec2 along = (to - from) / mesh.length(h);
    const Vec2& offset = unfolding.apex(h);
    const Vec2 apex = from + offset.x() * along + offset.y() * Vec2(-along.y(), along.x());
    if (end.is_vertex() ? mesh.apex(h) == end.vertex : Mesh::face_of(h) == end.point.face) {
      const Vec3& b = end.point.barycentric;
      const Vec2 place =
          end.is_vertex() ? apex : b[h % 3] * from + b[Mesh::next(h) % 3] * to + b[Mesh::prev(h) % 3] * apex;
      if ((place - goal).norm() <= tolerance) return (place - corner).norm();
    }
    const bool is_left = cross(goal - corner, apex - corner) > 0;
    h = mesh.twin(is_left ? Mesh::next(h) : Mesh::prev(h));
    (is_left ? from : to) = apex;
    if (cross(to - from, goal - from) < -tolerance * (to - from).norm()) break;  // the line ended before
  }
  return {};
}

}  // namespace saddleback
