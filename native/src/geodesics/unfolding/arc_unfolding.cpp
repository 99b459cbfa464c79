#include "geodesics/unfolding/arc_unfolding.h"

#include <algorithm>
#include <cmath>

#include "mesh/tables/outgoing.h"
#include "support/planar.h"

namespace saddleback {
namespace {

// Geodesics may run through vertices: they lie on the border of their windows, up to rounding, which is usually the
// least of these. All of a region that is smaller than a border is on it: there a way wanders without end, and only
// where that is less than 1e-12 of its length that is none of its length.
constexpr double k_on_border = 1e-13, k_on_loose_border = 1e-9, k_on_rough_border = 1e-5;

// The share of the longest length by which rounding moves one place.
constexpr double k_same_place = 1e-11;
// In a region that is millions of times smaller than its distance the ways in all directions have no end.
constexpr Index k_most_faces = 1 << 16;

bool same_length(double found, const ArcHint& hint) {
  return std::abs(found - hint.length) <= hint.tolerance * hint.length;
}

/// Tells whether no point of a segment is nearer to the origin.
bool is_beyond(const Vec2& from, const Vec2& to, double squared_length, double distance) {
  const Vec2 along = to - from;
  const double at = -from.dot(along), squared = distance * distance;
  if (at <= 0) return from.squaredNorm() > squared;
  if (at >= squared_length) return to.squaredNorm() > squared;
  const double area = cross(from, along);
  return area * area > squared * squared_length;
}

}  // namespace

bool ArcUnfolder::unfold(const ArcHint& hint, const SurfacePoint* target, UnfoldedArc& arc) {
  arc.entered.clear();
  arc.crossings.clear();
  target_ = target;
  if (!target && along_an_edge(hint, arc)) return true;
  if (hint.is_rough) return unfold_within(k_on_rough_border, hint, arc);
  return unfold_within(k_on_border, hint, arc) || unfold_within(k_on_loose_border, hint, arc);
}

bool ArcUnfolder::unfold_within(double border, const ArcHint& hint, UnfoldedArc& arc) {
  border_ = border;
  for (const Index h : outgoing(mesh_, hint.from)) {
    const double begin = unfolding_.polar(h);
    if (begin <= hint.end_angle && begin + mesh_.corner_angle(h) >= hint.begin_angle && start(hint, h, arc))
      return true;
  }
  return false;
}

bool ArcUnfolder::along_an_edge(const ArcHint& hint, UnfoldedArc& arc) const {
  const double straight = (mesh_.position(hint.to) - mesh_.position(hint.from)).norm();
  if (!mesh_.is_intrinsic() && straight < hint.length * (1 - 2 * hint.tolerance)) return false;
  for (const Index h : outgoing(mesh_, hint.from)) {
    if (mesh_.to(h) == hint.to && same_length(mesh_.length(h), hint)) {
      arc.length = mesh_.length(h);
      arc.start_angle = unfolding_.polar(h);
      arc.end_angle = unfolding_.polar_of_reverse(h);
      return true;
    }
    const Index last = Mesh::prev(h);
    if (mesh_.twin(last) == k_none && mesh_.from(last) == hint.to && same_length(mesh_.length(last), hint)) {
      arc.length = mesh_.length(last);
      arc.start_angle = mesh_.total_angle(hint.from);
      arc.end_angle = unfolding_.polar(last);
      return true;
    }
  }
  return false;
}

/// Starts through the face of a half-edge that leaves the source, in the frame of that half-edge.
bool ArcUnfolder::start(const ArcHint& hint, Index halfedge, UnfoldedArc& arc) {
  if (target_ && target_->face == Mesh::face_of(halfedge)) return inside_first_face(hint, halfedge, arc);
  const double base = unfolding_.polar(halfedge);
  const double right = std::max(hint.begin_angle - base, 0.0);
  const double left = std::min(hint.end_angle - base, mesh_.corner_angle(halfedge));
  stack_.clear();
  trail_.clear();
  push(Mesh::next(halfedge), 0, unfolding_.apex(halfedge), Vec2(mesh_.length(halfedge), 0),
       Vec2(std::cos(right), std::sin(right)), Vec2(std::cos(left), std::sin(left)));
  return search(hint, base, arc);
}

bool ArcUnfolder::inside_first_face(const ArcHint& hint, Index halfedge, UnfoldedArc& arc) const {
  const Vec3& b = target_->barycentric;
  const Vec2 place(
      b[(halfedge + 1) % 3] * mesh_.length(halfedge) + b[(halfedge + 2) % 3] * unfolding_.apex(halfedge).x(),
      b[(halfedge + 2) % 3] * unfolding_.apex(halfedge).y());
  arc.length = place.norm();
  arc.start_angle = unfolding_.polar(halfedge) + std::atan2(place.y(), place.x());
  return same_length(arc.length, hint);
}

bool ArcUnfolder::find_target(const ArcHint& hint, const Window& window, const Vec2& apex, Vec2& place) const {
  const Index h = window.entered;
  if (target_) {
    if (target_->face != Mesh::face_of(h)) return false;
    const Vec3& b = target_->barycentric;
    place = b[h % 3] * window.from + b[(h + 1) % 3] * window.to + b[(h + 2) % 3] * apex;
  } else {
    if (mesh_.apex(h) != hint.to) return false;
    place = apex;
  }
  const double reach = place.norm(), tolerance = border_ * reach;
  return same_length(reach, hint) && cross(window.right, place) >= -tolerance &&
         cross(place, window.left) >= -tolerance;
}

void ArcUnfolder::push(Index edge, Index depth, const Vec2& from, const Vec2& to, const Vec2& right, const Vec2& left) {
  if (const Index entered = mesh_.twin(edge); entered != k_none)
    stack_.push_back({entered, depth, from, to, right, left});
}

/// Tells whether a window without width has been there before. Past each vertex on its ray such a window goes on on
/// both sides: behind many in a row, as on the spokes of a wheel, each side would be followed once for every way that
/// leads there.
bool ArcUnfolder::was_followed(const Window& window, double farthest) {
  if (cross(window.right, window.left) > border_) return false;
  const double tolerance = k_same_place * farthest;
  const auto near = [&](const Vec2& a, const Vec2& b) { return (a - b).squaredNorm() <= tolerance * tolerance; };
  for (const Crossed& ray : rays_) {
    if (ray.entered == window.entered && near(ray.from, window.from) && near(ray.to, window.to)) return true;
  }
  rays_.push_back({window.entered, window.from, window.to});
  return false;
}

bool ArcUnfolder::search(const ArcHint& hint, double base_angle, UnfoldedArc& arc) {
  const double farthest = hint.length * (1 + hint.tolerance);
  rays_.clear();
  Index faces_left = std::max(k_most_faces, mesh_.face_count());
  while (!stack_.empty()) {
    Window window = stack_.back();
    stack_.pop_back();
    trail_.resize(window.depth);
    for (bool goes_on = true; goes_on;) {
      if (--faces_left < 0) return false;
      const Index h = window.entered;
      const Vec2 edge = window.to - window.from;
      const double squared = edge.squaredNorm();  // the mesh knows the length, but memory is slower than a root
      if (is_beyond(window.from, window.to, squared, farthest) || was_followed(window, farthest)) break;
      trail_.push_back({h, window.from, window.to});
      // As the other corners are placed, so that this one is as near to them as it should be.
      const Vec2 along = edge / (hint.is_rough ? mesh_.length(h) : std::sqrt(squared));
      const Vec2 offset = unfolding_.apex(h);
      const Vec2 apex = window.from + offset.x() * along + offset.y() * Vec2(-along.y(), along.x());
      if (Vec2 place; find_target(hint, window, apex, place)) return finish(window, place, base_angle, arc);
      const double reach = apex.norm(), tolerance = border_ * reach;
      const double from_right = cross(window.right, apex), to_left = cross(apex, window.left);
      const bool goes_left = to_left > -tolerance, goes_right = from_right > -tolerance;
      const Vec2 ray = apex / reach;
      const Vec2 right = from_right > 0 ? ray : window.right, left = to_left > 0 ? ray : window.left;
      // The right side now, the left side after it.
      if (goes_left && goes_right) push(Mesh::prev(h), window.depth + 1, window.from, apex, right, window.left);
      const Index next = mesh_.twin(goes_right ? Mesh::next(h) : Mesh::prev(h));
      goes_on = next != k_none && (goes_left || goes_right);
      if (goes_right) {
        window = {next, window.depth + 1, apex, window.to, window.right, left};
      } else {
        window = {next, window.depth + 1, window.from, apex, right, window.left};
      }
    }
  }
  return false;
}

bool ArcUnfolder::finish(const Window& last, const Vec2& target, double base_angle, UnfoldedArc& arc) {
  Vec2 at = Vec2::Zero();
  for (const Crossed& edge : trail_) {
    arc.entered.push_back(edge.entered);
    arc.crossings.push_back(crossed_share(edge.from, edge.to, target, at));
  }
  arc.length = target.norm();
  if (!with_angles_) return true;
  arc.start_angle = base_angle + std::atan2(target.y(), target.x());
  const Index leaving = Mesh::prev(last.entered);
  const Vec2 side = last.from - target;
  const double back = std::atan2(cross(side, -target), side.dot(-target));
  arc.end_angle = unfolding_.polar(leaving) + std::clamp(back, 0.0, mesh_.corner_angle(leaving));
  return true;
}

}  // namespace saddleback
