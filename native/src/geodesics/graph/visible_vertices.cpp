// Method: see window_propagation.h. All geometry is planar, in the frame of the half-edge that a window lies on: its
// origin at the half-edge's start, x along it, the face to be entered above, the unfolded source below. A child's
// source is rotated from its parent's, so nothing but the two coordinates is carried.

#include "geodesics/graph/visible_vertices.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace saddleback {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
// A distance replaces another only if it is shorter by more than rounding: keeps ties on regular grids from cycling.
constexpr double k_shorter = 1 - 1e-12;
// Radians, as in exact_propagation.cpp: a ray this close to a window's end meets the end, and narrower windows serve no
// further vertex.
constexpr double k_narrow = 1e-12, k_same_ray = 1e-7;
// Windows per settled vertex are 7 to 15 on any sane mesh; needles by the thousand round one vertex may exceed that
// without end, and stopping only costs arcs, never correctness.
constexpr Index k_windows_per_vertex = 256;
constexpr Index k_windows_at_least = 4096;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Tells whether the rays from the source through two places of the x axis lie less than that angle apart; not so where
/// the source itself lies on that axis, in one of the places: that ray leads anywhere.
bool is_within(double angle, const Vec2& source, double b, double c) {
  const double area = (c - b) * source.y(), y2 = source.y() * source.y();
  const double to_b = b - source.x(), to_c = c - source.x();
  return area * area < angle * angle * ((to_b * to_b + y2) * (to_c * to_c + y2));
}

}  // namespace

VisibleVertices::VisibleVertices(const Unfolding& unfolding)
    : unfolding_(unfolding),
      mesh_(unfolding.mesh()),
      vertices_(mesh_.vertex_count(), VertexState{}),
      occupants_(mesh_.halfedge_count(), Occupant{}) {}

void VisibleVertices::begin() {
  ++epoch_;
  windows_.clear();
  queue_.clear();
  touched_.clear();
  settled_ = windows_alive_ = direct_pending_ = 0;
}

VisibleVertices::VertexState& VisibleVertices::state(Index vertex) {
  VertexState& result = vertices_[vertex];
  if (result.epoch != epoch_) {
    result.distance = result.direct = k_infinity;
    result.epoch = epoch_;
    result.settled = result.neighbor = false;
    touched_.push_back(vertex);
  }
  return result;
}

double VisibleVertices::distance(Index vertex) const {
  const VertexState& v = vertices_[vertex];
  return v.epoch == epoch_ ? v.distance : k_infinity;
}

void VisibleVertices::push(const Event& event) {
  queue_.push_back(event);
  std::push_heap(queue_.begin(), queue_.end());
}

void VisibleVertices::push_window(const Window& window) {
  const double x = std::clamp(window.source.x(), window.b0, window.b1);
  const double key = Vec2(x - window.source.x(), window.source.y()).norm();
  windows_.push_back(window);
  ++windows_alive_;
  push({key, static_cast<Index>(windows_.size()) - 1});
}

void VisibleVertices::add_neighbor(Index vertex, double length, double start_angle, double end_angle) {
  VertexState& v = state(vertex);
  v.neighbor = true;
  if (length >= v.distance) return;
  if (!v.is_direct() || v.direct == k_infinity) ++direct_pending_;
  v.distance = v.direct = length;
  v.start_angle = start_angle;
  v.end_angle = end_angle;
  v.halfedge = k_none;
  push({length, ~vertex});
}

void VisibleVertices::offer_bound(Index vertex, double distance) {
  VertexState& v = state(vertex);
  if (v.settled || distance >= v.distance * k_shorter) return;
  if (v.direct < k_infinity && v.is_direct()) --direct_pending_;
  v.distance = distance;
  push({distance, ~vertex});
}

void VisibleVertices::offer_direct(Index vertex, double distance, const Window& window, const Vec2& offset) {
  VertexState& v = state(vertex);
  if (v.settled || distance >= v.direct * k_shorter || distance > v.distance) return;
  if (v.direct == k_infinity || !v.is_direct()) ++direct_pending_;
  v.distance = v.direct = distance;
  v.start_angle = window.rotation;
  v.offset = offset;
  v.halfedge = window.halfedge;
  push({distance, ~vertex});
}

void VisibleVertices::from_vertex(Index source, Index k, std::vector<DirectArc>& arcs, const JobStage& stage) {
  begin();
  VertexState& center = state(source);
  center.distance = 0;
  center.settled = true;
  const Index first = mesh_.first_halfedge(source);
  Index h = first;
  do {
    const Index opposite = Mesh::next(h), last = Mesh::prev(h);
    add_neighbor(mesh_.to(h), mesh_.length(h), unfolding_.polar(h), unfolding_.polar_of_reverse(h));
    if (const Index entered = mesh_.twin(opposite); entered != k_none) {
      // In the frame of `opposite` the source is the apex; its twin's frame is that one turned by half a circle.
      const Vec2 apex = unfolding_.apex(opposite);
      push_window({{unfolding_.to_end(opposite), -apex.y()},
                   0,
                   mesh_.length(opposite),
                   unfolding_.polar(h) - mesh_.corner_angle(opposite),
                   entered});
    }
    if (mesh_.twin(last) == k_none) {
      add_neighbor(mesh_.from(last), mesh_.length(last), mesh_.total_angle(source), unfolding_.polar(last));
    }
    h = mesh_.rotate(h);
  } while (h != k_none && h != first);
  run(k, stage);
  collect(arcs);
}

void VisibleVertices::from_point(const SurfacePoint& source, Index k, std::vector<DirectArc>& arcs,
                                 const JobStage& stage) {
  if (const Index vertex = vertex_at(mesh_, source); vertex != k_none) return from_vertex(vertex, k, arcs, stage);
  begin();
  const FaceChart chart(mesh_, source.face);
  const Vec2 center = chart.to_plane(source.barycentric);
  for (int corner = 0; corner < 3; ++corner) {
    const Index h = 3 * source.face + corner;
    const Vec2 start = chart.corner[corner], end = chart.corner[(corner + 1) % 3];
    const Vec2 along = (end - start).normalized(), there = start - center;
    const double back = std::atan2(cross(end - start, -there), (end - start).dot(-there));
    add_neighbor(mesh_.from(h), there.norm(), std::atan2(there.y(), there.x()),
                 unfolding_.polar(h) + std::clamp(back, 0.0, mesh_.corner_angle(h)));
    if (const Index entered = mesh_.twin(h); entered != k_none) {
      const Vec2 from_end = center - end;
      push_window({{-from_end.dot(along), std::min(0.0, -cross(along, from_end))},
                   0,
                   mesh_.length(h),
                   std::atan2(along.y(), along.x()) - std::numbers::pi,
                   entered});
    }
  }
  run(k, stage);
  collect(arcs);
}

void VisibleVertices::run(Index k, const JobStage& stage) {
  const Index most_windows = k_windows_per_vertex * std::min(k, Index{1} << 20) + k_windows_at_least;
  while (!queue_.empty() && settled_ < k && windows_alive_ + direct_pending_ > 0) {
    stage.check();
    const Event event = queue_.front();
    std::pop_heap(queue_.begin(), queue_.end());
    queue_.pop_back();
    if (event.id < 0) {
      const Index vertex = ~event.id;
      if (!vertices_[vertex].settled && event.key <= vertices_[vertex].distance) settle(vertex);
    } else {
      --windows_alive_;
      if (static_cast<Index>(windows_.size()) < most_windows) propagate(Window(windows_[event.id]));
    }
  }
}

void VisibleVertices::settle(Index vertex) {
  VertexState& v = vertices_[vertex];
  v.settled = true;
  ++settled_;
  if (v.is_direct()) {
    --direct_pending_;
    if (!mesh_.is_saddle(vertex))
      return;  // nothing bends here: its neighbors are seen directly or round another vertex
  }
  const double reached = v.distance;
  const Index first = mesh_.first_halfedge(vertex);
  Index h = first;
  do {
    offer_bound(mesh_.to(h), reached + mesh_.length(h));
    const Index last = Mesh::prev(h);
    if (mesh_.twin(last) == k_none) offer_bound(mesh_.from(last), reached + mesh_.length(last));
    h = mesh_.rotate(h);
  } while (h != k_none && h != first);
}

void VisibleVertices::propagate(const Window& window) {
  const Index h = window.halfedge, apex = mesh_.apex(h);
  const Vec2 offset = unfolding_.apex(h) - window.source;
  const double reach = offset.norm();
  // Where the ray to the apex crosses the half-edge.
  const double split = window.source.x() - offset.x() * (window.source.y() / offset.y());
  const bool meets_b0 = is_within(k_narrow, window.source, window.b0, split),
             meets_b1 = is_within(k_narrow, window.source, window.b1, split);
  const bool is_inside = split >= window.b0 && split <= window.b1;
  if (is_inside || meets_b0 || meets_b1) offer_direct(apex, reach, window, offset);

  const bool has_left = split > window.b0 && !meets_b0, has_right = split < window.b1 && !meets_b1;
  bool go_left = has_left, go_right = has_right;
  if (has_left && has_right) {
    Occupant& occupant = occupants_[h];
    if (occupant.epoch != epoch_ || reach < occupant.distance * k_shorter) {
      occupant = {reach, split, epoch_};
    } else if (!is_within(k_same_ray, window.source, split, occupant.split)) {
      // A nearer window has split this angle: behind its ray everything is nearer by the other one.
      go_left = split < occupant.split;
      go_right = !go_left;
    }
  }
  if (go_left) add_child(window, side_of(window, true), window.b0, std::min(window.b1, split), has_right);
  if (go_right) {
    const double base = mesh_.length(h);
    add_child(window, side_of(window, false), base - window.b1, base - std::max(window.b0, split), has_left);
  }
}

VisibleVertices::Side VisibleVertices::side_of(const Window& window, bool left) const {
  const Index h = window.halfedge;
  const Vec2 apex = unfolding_.apex(h);
  if (left) {
    const double length = mesh_.length(Mesh::prev(h));
    return {true, mesh_.from(h), mesh_.to(h), Mesh::prev(h), length, apex / length, window.source};
  }
  const double base = mesh_.length(h), length = mesh_.length(Mesh::next(h));
  return {false,
          mesh_.to(h),
          mesh_.from(h),
          Mesh::next(h),
          length,
          Vec2(unfolding_.to_end(h), apex.y()) / length,
          Vec2(base - window.source.x(), window.source.y())};
}

/// Makes the part of `parent` between `begin` and `end` (coordinates of the side) emit on the side's edge.
void VisibleVertices::add_child(const Window& parent, const Side& side, double begin, double end, bool to_apex) {
  const Index entered = mesh_.twin(side.edge);
  if (entered == k_none) return;
  const Vec2& s = side.source;
  const Vec2& u = side.direction;
  const auto hit = [&](double b) {  // where the ray through (b, 0) meets the edge, measured from the near vertex
    const double divisor = u.y() * (s.x() - b) - s.y() * u.x();
    return divisor > 0 ? std::min(-s.y() * b / divisor, side.length) : side.length;
  };
  const double q0 = hit(std::max(begin, 0.0)), q1 = to_apex ? side.length : hit(end);
  if (!(q1 > q0)) return;
  const Vec2 source(s.dot(u), std::min(0.0, cross(u, s)));
  const double base = mesh_.length(parent.halfedge);
  if (is_useless(side, source, q0, q1, mesh_.apex(parent.halfedge), base)) return;
  if (side.left) {
    push_window({source, q0, q1, parent.rotation + mesh_.corner_angle(parent.halfedge), entered});
  } else {
    const double turn = mesh_.corner_angle(Mesh::next(parent.halfedge));
    push_window(
        {{side.length - source.x(), source.y()}, side.length - q1, side.length - q0, parent.rotation - turn, entered});
  }
}

/// The three filters of Xin and Wang [xin2009]: some corner of the face offers every point of the child a shorter way.
bool VisibleVertices::is_useless(const Side& side, const Vec2& source, double q0, double q1, Index apex,
                                 double base) const {
  const double to_q0 = (source - Vec2(q0, 0)).norm(), to_q1 = (source - Vec2(q1, 0)).norm();
  if (distance(side.near) + q1 < to_q1 * k_shorter) return true;
  if (distance(apex) + (side.length - q0) < to_q0 * k_shorter) return true;
  const double across = (Vec2(base, 0) - q0 * side.direction).norm();
  return distance(side.far) + across < to_q0 * k_shorter;
}

void VisibleVertices::collect(std::vector<DirectArc>& arcs) {
  arcs.clear();
  for (const Index vertex : touched_) {
    const VertexState& v = vertices_[vertex];
    if (v.direct == k_infinity || !(v.neighbor || (v.settled && v.is_direct()))) continue;
    if (v.halfedge == k_none) {
      arcs.push_back({vertex, v.direct, v.start_angle, v.end_angle});
      continue;
    }
    const Vec2 apex = unfolding_.apex(v.halfedge);
    const double back = std::atan2(cross(apex, v.offset), apex.dot(v.offset));
    const Index leaving = Mesh::prev(v.halfedge);
    arcs.push_back({vertex, v.direct, v.start_angle + std::atan2(v.offset.y(), v.offset.x()),
                    unfolding_.polar(leaving) + std::clamp(back, 0.0, mesh_.corner_angle(leaving))});
  }
}

}  // namespace saddleback
