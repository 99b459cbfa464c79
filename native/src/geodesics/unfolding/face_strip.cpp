// A strip is laid out from its begin, which is the origin: the frame of the first half-edge to be crossed, moved there;
// every further face hangs on the half-edge by which it is entered.

#include "geodesics/unfolding/face_strip.h"

#include <algorithm>
#include <cmath>

#include "saddleback/mesh/surface_curve.h"

#include "support/planar.h"

namespace saddleback {
namespace {

/// Ends of a half-edge in the plane.
struct Placed {
  Vec2 from, to;
};

Vec2 apex_of(const Unfolding& unfolding, Index h, const Placed& place) {
  const Vec2 along = (place.to - place.from) / unfolding.mesh().length(h);
  const Vec2& offset = unfolding.apex(h);
  return place.from + offset.x() * along + offset.y() * Vec2(-along.y(), along.x());
}

/// A point of h's face, in the plane.
Vec2 place_of(const Mesh& mesh, const SurfacePoint& point, Index h, const Placed& place, const Vec2& apex) {
  const Vec3 b = barycentric_in(mesh, point, Mesh::face_of(h), k_barycentric_tolerance).value_or(point.barycentric);
  return b[h % 3] * place.from + b[(h + 1) % 3] * place.to + b[(h + 2) % 3] * apex;
}

/// The half-edge entered first, the begin being the origin.
Placed first_portal(const Unfolding& unfolding, const LegEnd& begin, Index entered) {
  const Mesh& mesh = unfolding.mesh();
  const Index g = mesh.twin(entered);
  const Placed own{Vec2(0, 0), Vec2(mesh.length(g), 0)};
  const Vec2& apex = unfolding.apex(g);
  const Vec2 origin = begin.is_vertex() ? apex : place_of(mesh, begin.point, g, own, apex);
  return {own.to - origin, own.from - origin};
}

Placed next_portal(const Mesh& mesh, Index h, const Placed& place, const Vec2& apex, Index entered) {
  if (mesh.twin(entered) == Mesh::prev(h)) return {place.from, apex};
  return {apex, place.to};
}

Vec2 end_of(const Mesh& mesh, const LegEnd& end, Index h, const Placed& place, const Vec2& apex) {
  return end.is_vertex() ? apex : place_of(mesh, end.point, h, place, apex);
}

/// Surface angle, at the vertex `h` leaves, of the direction to a point of h's face.
double angle_to(const Unfolding& unfolding, Index h, const SurfacePoint& point) {
  const Placed own{Vec2(0, 0), Vec2(unfolding.mesh().length(h), 0)};
  const Vec2 there = place_of(unfolding.mesh(), point, h, own, unfolding.apex(h));
  return unfolding.polar(h) + std::clamp(std::atan2(there.y(), there.x()), 0.0, unfolding.mesh().corner_angle(h));
}

void lay_out_in_face(const Unfolding& unfolding, const LegEnd& begin, const LegEnd& end, UnfoldedArc& leg) {
  const Mesh& mesh = unfolding.mesh();
  leg.length = 0;
  const Index face = shared_face(mesh, begin.point, end.point, k_barycentric_tolerance);
  if (face == k_none) return;
  const auto a = barycentric_in(mesh, begin.point, face, k_barycentric_tolerance);
  const auto b = barycentric_in(mesh, end.point, face, k_barycentric_tolerance);
  const FaceChart chart(mesh, face);
  leg.length = (chart.to_plane(*b) - chart.to_plane(*a)).norm();
  const Index from = begin.is_vertex() ? leaving(mesh, begin.vertex, face) : k_none;
  const Index to = end.is_vertex() ? leaving(mesh, end.vertex, face) : k_none;
  if (from != k_none) leg.start_angle = angle_to(unfolding, from, {face, *b});
  if (to != k_none) leg.end_angle = angle_to(unfolding, to, {face, *a});
}

}  // namespace

LegEnd leg_end(const Mesh& mesh, const SurfacePoint& point) { return {vertex_at(mesh, point), point}; }
LegEnd leg_end(const Mesh& mesh, Index vertex) { return {vertex, at_vertex(mesh, vertex)}; }

Index leaving(const Mesh& mesh, Index vertex, Index face) {
  for (Index h = 3 * face; h < 3 * face + 3; ++h)
    if (mesh.from(h) == vertex) return h;
  return k_none;
}

void lay_out(const Unfolding& unfolding, const LegEnd& begin, const LegEnd& end, std::span<const Index> entered,
             UnfoldedArc& leg) {
  leg.entered.assign(entered.begin(), entered.end());
  leg.crossings.clear();
  if (entered.empty()) return lay_out_in_face(unfolding, begin, end, leg);
  const Mesh& mesh = unfolding.mesh();
  std::vector<Placed> portals;
  portals.reserve(entered.size());
  Placed place = first_portal(unfolding, begin, entered[0]);
  for (std::size_t i = 0;; ++i) {
    portals.push_back(place);
    const Vec2 apex = apex_of(unfolding, entered[i], place);
    if (i + 1 < entered.size()) {
      place = next_portal(mesh, entered[i], place, apex, entered[i + 1]);
      continue;
    }
    const Vec2 target = end_of(mesh, end, entered[i], place, apex);
    Vec2 at = Vec2::Zero();
    for (const Placed& portal : portals) leg.crossings.push_back(crossed_share(portal.from, portal.to, target, at));
    leg.length = target.norm();
    if (begin.is_vertex()) {
      const Index h = Mesh::prev(mesh.twin(entered[0]));
      const Vec2 side = portals[0].to;  // where h leads
      const double angle = std::atan2(cross(side, target), side.dot(target));
      leg.start_angle = unfolding.polar(h) + std::clamp(angle, 0.0, mesh.corner_angle(h));
    }
    if (end.is_vertex()) {
      const Index h = Mesh::prev(entered[i]);
      const Vec2 side = place.from - target;
      const double angle = std::atan2(cross(side, -target), side.dot(-target));
      leg.end_angle = unfolding.polar(h) + std::clamp(angle, 0.0, mesh.corner_angle(h));
    }
    return;
  }
}

void reverse(const Mesh& mesh, UnfoldedArc& leg) {
  std::swap(leg.start_angle, leg.end_angle);
  std::reverse(leg.entered.begin(), leg.entered.end());
  std::reverse(leg.crossings.begin(), leg.crossings.end());
  for (Index& h : leg.entered) h = mesh.twin(h);
  for (double& t : leg.crossings) t = 1 - t;
}

std::span<const StripTurn> Funnel::turns(const LegEnd& begin, const LegEnd& end, std::span<const Index> entered) {
  turns_.clear();
  if (entered.empty()) return turns_;
  const Mesh& mesh = unfolding_.mesh();
  left_.clear();
  right_.clear();
  Placed place = first_portal(unfolding_, begin, entered[0]);
  for (std::size_t i = 0; i < entered.size(); ++i) {
    left_.push_back(place.from);
    right_.push_back(place.to);
    const Vec2 apex = apex_of(unfolding_, entered[i], place);
    if (i + 1 < entered.size()) {
      place = next_portal(mesh, entered[i], place, apex, entered[i + 1]);
    } else {
      const Vec2 target = end_of(mesh, end, entered[i], place, apex);
      left_.push_back(target);
      right_.push_back(target);
    }
  }
  const auto turn_at = [&](std::size_t i, bool at_left) {
    const Index vertex = at_left ? mesh.from(entered[i]) : mesh.to(entered[i]);
    const auto meets = [&](std::size_t j) { return mesh.from(entered[j]) == vertex || mesh.to(entered[j]) == vertex; };
    StripTurn turn{vertex, i, i + 1};
    while (turn.first > 0 && meets(turn.first - 1)) --turn.first;
    while (turn.last < entered.size() && meets(turn.last)) ++turn.last;
    turns_.push_back(turn);
    return turn.last;
  };
  // The funnel: an apex and the two lines that bound what it sees of the portals so far.
  Vec2 apex = Vec2::Zero(), left = left_[0], right = right_[0];
  std::size_t left_at = 0, right_at = 0;
  for (std::size_t i = 1; i < left_.size(); ++i) {
    const auto restart = [&](std::size_t at, bool at_left) {
      const Vec2 corner = at_left ? left_[at] : right_[at];
      const std::size_t next = turn_at(at, at_left);  // beyond all portals that end at the corner
      apex = corner;
      left = left_[next];
      right = right_[next];
      left_at = right_at = i = next;
    };
    const Vec2 new_left = left_[i] - apex, new_right = right_[i] - apex;
    if (cross(right - apex, new_right) >= 0) {  // the right line closes in
      if (cross(new_right, left - apex) < 0) {
        restart(left_at, true);
        continue;
      }
      right = right_[i];
      right_at = i;
    }
    if (cross(new_left, left - apex) >= 0) {
      if (cross(right - apex, new_left) < 0) {
        restart(right_at, false);
        continue;
      }
      left = left_[i];
      left_at = i;
    }
  }
  return turns_;
}

}  // namespace saddleback
