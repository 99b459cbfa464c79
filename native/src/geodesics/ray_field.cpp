// See ray_field.h. Sources are rotated from frame to frame, perpendicular rays as a direction and a linear function:
// distance at p = offset + direction . p, arc length at p = value + tangent . p.

#include "geodesics/ray_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace saddleback {
namespace {

constexpr double k_pi = std::numbers::pi;
constexpr double k_infinity = std::numeric_limits<double>::infinity();
// A distance replaces another only if it is shorter by more than rounding: keeps ties on regular grids from cycling.
constexpr double k_shorter = 1 - 1e-12;
// Of ways that are equally long but for rounding the one without a bend is kept.
constexpr double k_as_short = 1 + 1e-12;
// What a filter must win by, relative to the distance: rounding over thousands of faces stays below it.
constexpr double k_slack = 1 - 1e-11;
// Relative to the edge or, where that is less, to how far the rays have come: narrower windows are not made, see
// exact_propagation.cpp. A ray to an apex that misses its window by no more than the gap that they leave (relative to
// the edge), or by rounding (relative to the ray), counts with the detour round the window's end.
constexpr double k_sliver = 1e-10, k_gap = 1e-7, k_ray_gap = 1e-13;
// A total angle above 2 pi by no more than this is flat: what lies behind is seen past the vertex.
constexpr double k_flat = 1e-9;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }
Vec2 turned(const Vec2& v, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

/// What is too narrow for a window on an edge of that length.
double sliver(const RayWindow& window, double length) {
  if (window.rays == Rays::perpendicular) return k_sliver * length;
  const double x = std::clamp(window.source.x(), window.b0, window.b1);
  return k_sliver * std::min(length, std::abs(x - window.source.x()) - window.source.y());
}

/// Direction of increasing arc length.
Vec2 tangent(const RayWindow& window) { return window.side * Vec2(window.source.y(), -window.source.x()); }

}  // namespace

double distance_at(const RayWindow& window, double x) {
  if (window.rays == Rays::perpendicular) return window.offset + window.source.x() * x;
  return window.offset + std::hypot(x - window.source.x(), window.source.y());
}

bool window_of_corner(const Unfolding& unfolding, Index h, double begin, double end, RayWindow& window) {
  const Mesh& mesh = unfolding.mesh();
  const Index opposite = Mesh::next(h), entered = mesh.twin(opposite);
  if (entered == k_none) return false;
  const double base = mesh.length(opposite);
  const Vec2& apex = unfolding.apex(opposite);  // the twin's frame is turned by half a circle
  const double corner = mesh.corner_angle(h);
  const auto met = [&](double angle) {
    const Vec2 ray = turned(apex, angle);
    return ray.y() > 0 ? std::clamp(base - apex.x() + apex.y() * ray.x() / ray.y(), 0.0, base) : 0.0;
  };
  window.source = {base - apex.x(), -apex.y()};
  window.b0 = end >= corner ? 0 : met(end);
  window.b1 = begin <= 0 ? base : met(begin);
  window.halfedge = entered;
  return window.b1 - window.b0 > k_sliver * base;
}

RayField::RayField(const Unfolding& unfolding)
    : unfolding_(unfolding),
      mesh_(unfolding.mesh()),
      vertices_(mesh_.vertex_count(), VertexState{}),
      occupants_(mesh_.halfedge_count(), Occupant{}),
      barriers_(unfolding) {}

void RayField::begin(const WatchedPlaces* places) {
  ++epoch_;
  places_.reset(places);
  windows_.clear();
  free_windows_.clear();
  queue_.clear();
  settled_.clear();
  barriers_.clear();
  limits_ = {};
}

RayField::VertexState& RayField::state(Index vertex) {
  VertexState& result = vertices_[vertex];
  if (result.epoch != epoch_) {
    result.label = {};
    result.epoch = epoch_;
    result.settled = false;
  }
  return result;
}

double RayField::distance(Index vertex) const {
  const VertexState& v = vertices_[vertex];
  return v.epoch == epoch_ ? v.label.distance : k_infinity;
}

void RayField::push(const Event& event) {
  if (event.key > limits_.radius) return;
  queue_.push_back(event);
  std::push_heap(queue_.begin(), queue_.end());
}

bool RayField::improve(Index vertex, const RayLabel& label, const Vec2& ray, Index halfedge) {
  VertexState& v = state(vertex);
  const bool shorter = label.distance < v.label.distance * k_shorter;
  const bool straighter = !label.shadowed && v.label.shadowed && label.distance <= v.label.distance * k_as_short;
  if (!shorter && !straighter) return false;
  v.label = label;
  v.ray = ray;
  v.halfedge = halfedge;
  if (!v.settled) push({label.distance, ~vertex});
  return true;
}

void RayField::offer(Index vertex, const RayLabel& label, double back) { improve(vertex, label, {back, 0}, k_none); }

void RayField::add_source(Index vertex, const RayLabel& label) {
  VertexState& v = state(vertex);
  if (v.settled) return;
  settled_.push_back(vertex);
  v.settled = true;
  v.label = label;
}

void RayField::add_window(const RayWindow& window) {
  barriers_.for_each_free_part(window, RayBarriers::Side::left, [this](const RayWindow& part) { push(part); });
}

void RayField::push(const RayWindow& window) {
  double key = 0;
  if (window.rays == Rays::perpendicular) {
    key = std::max(0.0, std::min(distance_at(window, window.b0), distance_at(window, window.b1)));
  } else {
    key = distance_at(window, std::clamp(window.source.x(), window.b0, window.b1));
  }
  if (is_too_far(window, key)) return;
  Index id = static_cast<Index>(windows_.size());
  if (free_windows_.empty()) {
    windows_.push_back(window);
  } else {
    id = free_windows_.back();
    free_windows_.pop_back();
    windows_[id] = window;
  }
  push({key, id});
}

bool RayField::is_too_far(const RayWindow& window, double key) const {
  if (key > limits_.radius) return true;
  if (!std::isfinite(limits_.edges)) return false;
  const Index h = window.halfedge;
  const double edge = std::max({mesh_.length(h), mesh_.length(Mesh::next(h)), mesh_.length(Mesh::prev(h))});
  return key > limits_.edges * edge;
}

void RayField::run(const RayLimits& limits, const JobStage& stage, DistanceProgress* progress) {
  limits_ = limits;
  int countdown = 1;
  while (!queue_.empty() && static_cast<Index>(settled_.size()) < limits_.k) {
    const Event event = queue_.front();
    if (event.key > limits_.radius) break;
    std::pop_heap(queue_.begin(), queue_.end());
    queue_.pop_back();
    if (--countdown <= 0) {
      countdown = 256;
      stage.check();
      if (progress) progress->reached(event.key);
    }
    if (event.id >= 0) {
      const RayWindow window = windows_[event.id];
      free_windows_.push_back(event.id);
      barriers_.for_each_free_part(window, RayBarriers::Side::entered,
                                   [this](const RayWindow& part) { propagate(part); });
    } else if (VertexState& v = vertices_[~event.id]; !v.settled && event.key <= v.label.distance) {
      v.settled = true;
      settled_.push_back(~event.id);
      settle(~event.id);
    }
  }
}

double RayField::angle_back(Index vertex) const {
  const VertexState& v = vertices_[vertex];
  if (v.halfedge == k_none) return v.ray.x();
  const Vec2& apex = unfolding_.apex(v.halfedge);
  const Index leaving = Mesh::prev(v.halfedge);
  const double angle = std::atan2(cross(apex, v.ray), apex.dot(v.ray));
  return unfolding_.polar(leaving) + std::clamp(angle, 0.0, mesh_.corner_angle(leaving));
}

/// A shortest path may go on from a saddle vertex in any direction that leaves at least pi on either side.
void RayField::settle(Index vertex) {
  if (!mesh_.is_saddle(vertex)) return;
  const double total = mesh_.total_angle(vertex), back = angle_back(vertex);
  if (mesh_.is_boundary(vertex)) {
    if (back - k_pi >= -k_flat) shine_from(vertex, 0, back - k_pi);
    if (back + k_pi <= total + k_flat) shine_from(vertex, back + k_pi, total);
  } else if (total > 2 * k_pi + k_flat) {
    const double begin = back + k_pi, end = back + total - k_pi;
    shine_from(vertex, begin, std::min(end, total));
    if (end > total) shine_from(vertex, std::max(0.0, begin - total), end - total);
  }
}

void RayField::shine_from(Index vertex, double begin, double end) {
  const RayLabel own = vertices_[vertex].label;
  RayWindow window{Vec2::Zero(), 0, 0, own.distance, own.value, k_none, Rays::from_foot, own.side, true};
  RayLabel label = own;
  label.shadowed = true;
  const Index first = mesh_.first_halfedge(vertex);
  Index h = first;
  do {
    const double from = begin - unfolding_.polar(h), to = end - unfolding_.polar(h), corner = mesh_.corner_angle(h);
    if (from <= corner + k_flat && to >= -k_flat) {
      if (from <= k_flat) {
        label.distance = own.distance + mesh_.length(h);
        offer(mesh_.to(h), label, unfolding_.polar_of_reverse(h));
      }
      if (to >= corner - k_flat) {
        const Index last = Mesh::prev(h);
        label.distance = own.distance + mesh_.length(last);
        offer(mesh_.from(last), label, unfolding_.polar(last));
      }
      if (window_of_corner(unfolding_, h, from, to, window)) add_window(window);
    }
    h = mesh_.rotate(h);
  } while (h != k_none && h != first);
}

void RayField::propagate(const RayWindow& window) {
  const Index h = window.halfedge;
  const Vec2& apex = unfolding_.apex(h);
  const bool is_parallel = window.rays == Rays::perpendicular;
  const Vec2 ray = is_parallel ? window.source : Vec2(apex - window.source);
  if (ray.y() <= 0) return;  // grazes the edge: only rounding brings it here
  if (!places_.empty()) reach_places(window);
  const double reach = is_parallel ? window.offset + window.source.dot(apex) : window.offset + ray.norm();
  const double least = sliver(window, mesh_.length(h)),
               gap = k_gap * mesh_.length(h) + k_ray_gap * (reach - window.offset);
  // Where the ray to the apex crosses the half-edge.
  const double split = apex.x() - ray.x() * (apex.y() / ray.y());
  if (split >= window.b0 - gap && split <= window.b1 + gap) {
    RayLabel label{reach, window.value, window.side, window.shadowed};
    if (const double b = std::clamp(split, window.b0, window.b1); b != split)
      label.distance = distance_at(window, b) + std::hypot(apex.x() - b, apex.y());
    if (window.rays == Rays::from_point) label.value += std::atan2(ray.y(), ray.x());
    if (is_parallel) label.value += tangent(window).dot(apex);
    improve(mesh_.apex(h), label, ray, h);
  }
  const bool has_left = split > window.b0 + least, has_right = split < window.b1 - least;
  bool go_left = has_left, go_right = has_right;
  if (has_left && has_right) {
    Occupant& occupant = occupants_[h];
    if (occupant.epoch != epoch_ || reach < occupant.distance * k_shorter) {
      occupant = {reach, split, epoch_};
    } else if (std::abs(split - occupant.split) > least || reach > occupant.distance * k_as_short) {
      // A nearer window has split this angle: behind its ray everything is nearer by the other one. (The same ray, of
      // pieces of a curve that lie on each other, hides nothing.)
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

/// Of the places in the face that the window enters those that its rays meet.
void RayField::reach_places(const RayWindow& window) {
  const Index h = window.halfedge;
  const double base = mesh_.length(h), tolerance = k_sliver * base;
  places_.places().in_face(Mesh::face_of(h), [&](Index index, const Vec3& weights) {
    const Vec2 place = weights[Mesh::next(h) % 3] * Vec2(base, 0) + weights[Mesh::prev(h) % 3] * unfolding_.apex(h);
    const bool is_parallel = window.rays == Rays::perpendicular;
    const Vec2 ray = is_parallel ? window.source : Vec2(place - window.source);
    if (ray.y() <= 0) return;
    const double crossing = place.x() - ray.x() * (place.y() / ray.y());
    if (crossing < window.b0 - tolerance || crossing > window.b1 + tolerance) return;
    places_.offer(index, window.offset + (is_parallel ? window.source.dot(place) : ray.norm()));
  });
}

RayField::Side RayField::side_of(const RayWindow& window, bool left) const {
  const Index h = window.halfedge;
  const Vec2& apex = unfolding_.apex(h);
  const Vec2& s = window.source;
  if (left) {
    const double length = mesh_.length(Mesh::prev(h));
    return {true, mesh_.from(h), mesh_.to(h), Mesh::prev(h), length, apex / length, s};
  }
  const double base = mesh_.length(h), length = mesh_.length(Mesh::next(h));
  const double x = window.rays == Rays::perpendicular ? -s.x() : base - s.x();
  return {false,     mesh_.to(h), mesh_.from(h), Mesh::next(h), length, Vec2(base - apex.x(), apex.y()) / length,
          {x, s.y()}};
}

/// Makes the part of `parent` between `begin` and `end` (coordinates of the side) shine on the side's edge.
void RayField::add_child(const RayWindow& parent, const Side& side, double begin, double end, bool to_apex) {
  const Index entered = mesh_.twin(side.edge);
  if (entered == k_none) return;
  const bool is_parallel = parent.rays == Rays::perpendicular;
  const Vec2 &s = side.source, &u = side.direction;
  const auto hit = [&](double b) {  // where the ray through (b, 0) meets the edge, measured from the near vertex
    const Vec2 ray = is_parallel ? s : Vec2(b - s.x(), -s.y());
    const double divisor = cross(u, ray);
    return divisor > 0 ? std::min(b * ray.y() / divisor, side.length) : side.length;
  };
  const double q0 = hit(std::max(begin, 0.0)), q1 = to_apex ? side.length : hit(end);
  RayWindow child = parent;
  child.halfedge = entered;
  child.b0 = q0;
  child.b1 = q1;
  child.source = {s.dot(u), cross(u, s)};
  if (!is_parallel) child.source.y() = std::min(0.0, child.source.y());
  if (!(q1 - q0 > sliver(child, side.length))) return;
  const Index h = parent.halfedge;
  // In the side's coordinates, the origin being the near vertex.
  const double base = mesh_.length(h);
  if (is_parallel && !side.left) child.offset += parent.source.x() * base;
  if (is_useless(side, child, q0, q1, mesh_.apex(h), base)) return;
  if (side.left) {
    if (parent.rays == Rays::from_point) child.value += mesh_.corner_angle(h);
  } else {
    child.b0 = side.length - q1;
    child.b1 = side.length - q0;
    if (is_parallel) {
      const Vec2& apex = unfolding_.apex(h);
      child.source.x() = -child.source.x();
      child.offset = parent.offset + parent.source.dot(apex);
      child.value += tangent(parent).dot(apex);
    } else {
      child.source.x() = side.length - child.source.x();
      if (parent.rays == Rays::from_point) child.value -= mesh_.corner_angle(Mesh::next(h));
    }
  }
  if (is_parallel && child.source.y() <= 0) return;
  push(child);
}

/// The three filters of Xin and Wang: some corner of the face offers every point of the child a shorter way. They hold
/// for perpendicular rays as well: all they need is that nothing is nearer than the rays say.
bool RayField::is_useless(const Side& side, const RayWindow& child, double q0, double q1, Index apex,
                          double base) const {
  const double to_q0 = distance_at(child, q0), to_q1 = distance_at(child, q1);
  if (distance(side.near) + q1 < to_q1 * k_slack) return true;
  if (distance(apex) + (side.length - q0) < to_q0 * k_slack) return true;
  const double across = std::hypot(base - q0 * side.direction.x(), q0 * side.direction.y());
  return distance(side.far) + across < to_q0 * k_slack;
}

}  // namespace saddleback
