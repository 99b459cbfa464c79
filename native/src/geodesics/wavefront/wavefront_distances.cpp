// See wavefront_distances.h. Sources are rotated from frame to frame, perpendicular rays as a direction and a linear
// function: distance at p = offset + direction . p, arc length at p = value + tangent . p.

#include "geodesics/wavefront/wavefront_distances.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "geodesics/unfolding/common_length.h"
#include "geodesics/unfolding/tips.h"
#include "mesh/tables/outgoing.h"

namespace saddleback {
namespace {

constexpr double k_pi = std::numbers::pi;
constexpr double k_infinity = std::numeric_limits<double>::infinity();
// A distance replaces another only if it is shorter by more than rounding: keeps ties on regular grids from cycling.
constexpr double k_shorter = 1 - 1e-12;
// The rounding of equal lengths: of two such ways the one without a bend is kept.
constexpr double k_as_short = 1 + 1e-12;
// The margin by which a filter must win, relative to the distance: rounding over thousands of faces stays below it.
constexpr double k_slack = 1 + 1e-11;
// Radians, or of parallel rays a share of the edge: narrower windows are not made, and a ray to an apex that misses its
// window by no more counts with the detour round the window's end. See exact_propagation.cpp.
constexpr double k_narrow = 1e-12, k_miss = 1e-7;
constexpr double k_rounding = 16 * std::numeric_limits<double>::epsilon(), k_near = 1.0 / 16;  // as there
// Relative to the edge: a place beside a window by no more is in it.
constexpr double k_at_border = 1e-10;
// A total angle above 2 pi by no more than this is flat: what lies behind is seen past the vertex.
constexpr double k_flat = 1e-9;
constexpr double k_buckets_per_edge = 4;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }
double length_of(double x, double y) { return std::sqrt(x * x + y * y); }
Vec2 turned(const Vec2& v, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

/// Rays out of a point.
struct Radial {
  static constexpr bool is_parallel = false;
  static Vec2 ray(const RayWindow& w, const Vec2& to) { return to - w.source; }
  static double distance(const RayWindow& w, double x) { return w.offset + length_of(x - w.source.x(), w.source.y()); }
  static double distance(const RayWindow& w, const Vec2& ray, const Vec2&) {
    return w.offset + length_of(ray.x(), ray.y());
  }
  /// Tells whether `length` is less than the distance at x, without a root.
  static bool is_less(double length, const RayWindow& w, double x) {
    const double own = length - w.offset, dx = x - w.source.x();
    return own < 0 || own * own < dx * dx + w.source.y() * w.source.y();
  }
  static double least(const RayWindow& w) {
    if (w.b0 <= w.source.x() && w.source.x() <= w.b1) return w.offset - w.source.y();
    return distance(w, w.source.x() < w.b0 ? w.b0 : w.b1);
  }
  /// Tells whether the rays through two places of an edge of that length are no farther from each other.
  static bool is_within(double angle, const RayWindow& w, double, double b, double c) {
    const double x = w.source.x(), y2 = w.source.y() * w.source.y(), width = c - b;
    return width * width * y2 <= angle * angle * (((b - x) * (b - x) + y2) * ((c - x) * (c - x) + y2));
  }
  /// Twice the area between rays to the ends of a part of the window, and a bound from which on that is not narrow.
  static double area(const RayWindow& w, double width) { return -w.source.y() * width; }
  static double wide(const RayWindow& w, double) {
    const double to_b0 = w.b0 - w.source.x(), to_b1 = w.b1 - w.source.x();
    return k_narrow * (to_b0 * to_b0 + to_b1 * to_b1 + 2 * w.source.y() * w.source.y());
  }
  /// Makes neighbors overlap near the root, where rays differ by less than the rounding of an edge.
  static void widen(RayWindow& w, double length) {
    const double x = w.source.x(), y2 = w.source.y() * w.source.y();
    const double to_b0 = (w.b0 - x) * (w.b0 - x) + y2, to_b1 = (w.b1 - x) * (w.b1 - x) + y2;
    if (std::min(to_b0, to_b1) >= k_near * k_near * length * length) [[likely]]
      return;
    const double share = k_rounding * length / std::max(-w.source.y(), k_rounding * length);
    w.b0 = std::max(0.0, w.b0 - share * std::sqrt(to_b0));
    w.b1 = std::min(length, w.b1 + share * std::sqrt(to_b1));
  }
};

/// Rays at right angles to a straight piece of curve.
struct Parallel {
  static constexpr bool is_parallel = true;
  static const Vec2& ray(const RayWindow& w, const Vec2&) { return w.source; }
  static double distance(const RayWindow& w, double x) { return w.offset + w.source.x() * x; }
  static double distance(const RayWindow& w, const Vec2&, const Vec2& to) { return w.offset + w.source.dot(to); }
  static bool is_less(double length, const RayWindow& w, double x) { return length < distance(w, x); }
  static double least(const RayWindow& w) { return std::max(0.0, distance(w, w.source.x() > 0 ? w.b0 : w.b1)); }
  static bool is_within(double share, const RayWindow&, double length, double b, double c) {
    return std::abs(c - b) <= share * length;
  }
  static double area(const RayWindow&, double width) { return width; }
  static double wide(const RayWindow&, double length) { return k_narrow * length; }
  static void widen(RayWindow&, double) {}
};

/// Direction of increasing arc length.
Vec2 tangent(const RayWindow& window) { return window.side * Vec2(window.source.y(), -window.source.x()); }

/// Tells whether a ray has gone all round a tip within its faces. It crosses an edge to the tip so far from the tip,
/// with the tip ahead along x, and has its root so many times `ray` back.
bool circles_near(const WavefrontDistances::Tip& tip, double away, const Vec2& ray, double root) {
  if (!(away < tip.reach) || !circles(tip.tangent, ray.x(), ray.y())) return false;
  const double back = away / (ray.y() / tip.tangent - ray.x());  // where it crossed that edge before
  return back < root && back * ray.y() < tip.reach * tip.sine;
}

RayWindow vertex_event(Index vertex, double distance) {
  return {Vec2::Zero(), 0, 0, distance, 0, ~vertex, Rays::from_foot, 0, false};
}

}  // namespace

bool window_of_corner(const Unfolding& unfolding, Index h, double begin, double end, RayWindow& window) {
  const Mesh& mesh = unfolding.mesh();
  const Index opposite = Mesh::next(h), entered = mesh.twin(opposite);
  if (entered == k_none) return false;
  const double base = mesh.length(opposite);
  const Vec2& apex = unfolding.apex(opposite);  // the twin's frame is turned by half a circle
  const double corner = mesh.corner_angle(h), to_end = unfolding.to_end(opposite);
  const auto met = [&](double angle) {
    const Vec2 ray = turned(apex, angle);
    return ray.y() > 0 ? std::clamp(to_end + apex.y() * ray.x() / ray.y(), 0.0, base) : 0.0;
  };
  window.source = {to_end, -apex.y()};
  window.b0 = end >= corner ? 0 : met(end);
  window.b1 = begin <= 0 ? base : met(begin);
  window.halfedge = entered;
  return std::min(end, corner) - std::max(begin, 0.0) > k_narrow && window.b1 > window.b0;
}

WavefrontDistances::WavefrontDistances(const Unfolding& unfolding)
    : unfolding_(unfolding),
      mesh_(unfolding.mesh()),
      distances_(mesh_.vertex_count(), k_infinity),
      vertices_(mesh_.vertex_count(), VertexState{}),
      occupants_(mesh_.halfedge_count(), Occupant{}),
      barriers_(unfolding),
      queue_(common_length(mesh_) / k_buckets_per_edge) {
  for (Index v = 0; v < mesh_.vertex_count(); ++v) {
    const double tangent = tangent_of_tip(mesh_, v);
    if (!std::isfinite(tangent)) continue;
    tips_.resize(mesh_.vertex_count());
    tips_[v] = {tangent, std::sin(mesh_.total_angle(v)), k_infinity};
    for (const Index h : outgoing(mesh_, v)) {
      const Index opposite = Mesh::next(h);
      const Vec2 apex = unfolding_.apex(opposite), nearest(std::clamp(apex.x(), 0.0, mesh_.length(opposite)), 0);
      tips_[v].reach = std::min(tips_[v].reach, (apex - nearest).norm());
    }
  }
}

void WavefrontDistances::begin(const WatchedPlaces* places) {
  ++epoch_;
  places_.reset(places);
  queue_.clear();
  due_.clear();
  settled_.clear();
  for (const Index vertex : reached_) distances_[vertex] = k_infinity;
  for (const Index vertex : with_longest_) longest_[vertex] = 0;
  with_longest_.clear();
  reached_.clear();
  barriers_.clear();
  limits_ = {};
}

WavefrontDistances::VertexState& WavefrontDistances::state(Index vertex) {
  VertexState& result = vertices_[vertex];
  if (std::isinf(distances_[vertex])) {
    reached_.push_back(vertex);
    result.bent_at = k_infinity;
    result.is_source = false;
  }
  return result;
}

bool WavefrontDistances::improves(Index vertex, double distance, bool shadowed) const {
  if (distance < distances_[vertex] * k_shorter) return true;
  return !shadowed && distance <= distances_[vertex] * k_as_short && vertices_[vertex].label.shadowed;
}

void WavefrontDistances::improve(Index vertex, const RayLabel& label, const Vec2& ray, Index halfedge) {
  VertexState& v = state(vertex);
  v.label = label;
  distances_[vertex] = label.distance;
  v.ray = ray;
  v.halfedge = halfedge;
  if (mesh_.is_saddle(vertex)) queue_.push(vertex_event(vertex, label.distance), label.distance);
}

void WavefrontDistances::offer(Index vertex, const RayLabel& label, double back) {
  if (improves(vertex, label.distance, label.shadowed)) improve(vertex, label, {back, 0}, k_none);
}

void WavefrontDistances::add_source(Index vertex, const RayLabel& label) {
  VertexState& v = state(vertex);
  if (v.is_source) return;
  v.is_source = true;
  v.label = label;
  distances_[vertex] = label.distance;
}

void WavefrontDistances::add_window(const RayWindow& window) {
  barriers_.for_each_free_part(window, RayBarriers::Side::left, [this](const RayWindow& part) { push(part); });
}

void WavefrontDistances::push(const RayWindow& window) {
  const double key = window.rays == Rays::perpendicular ? Parallel::least(window) : Radial::least(window);
  if (!is_too_far(window, key)) queue_.push(window, key);
}

bool WavefrontDistances::is_too_far(const RayWindow& window, double key) {
  if (key > limits_.radius) return true;
  return std::isfinite(limits_.edges) && key > limits_.edges * longest_to_apex(window.halfedge);
}

/// The longest edge on the way through a half-edge to the vertex opposite, for which it is kept. For corners of the
/// face where the way sets out nothing is kept: that face speaks for them.
double WavefrontDistances::longest_to_apex(Index h) {
  const auto longest_at = [&](Index g) {
    return std::max({mesh_.length(g), mesh_.length(Mesh::next(g)), mesh_.length(Mesh::prev(g))});
  };
  const auto longest_to = [&](Index v) {
    return longest_[v] > 0 || mesh_.twin(h) == k_none ? longest_[v] : longest_at(mesh_.twin(h));
  };
  const double longest = std::max(longest_at(h), std::min(longest_to(mesh_.from(h)), longest_to(mesh_.to(h))));
  double& kept = longest_[mesh_.apex(h)];
  if (kept == 0) with_longest_.push_back(mesh_.apex(h));
  if (kept == 0 || longest < kept) kept = longest;
  return longest;
}

void WavefrontDistances::run(const RayLimits& limits, const JobStage& stage, const ReportRays& report) {
  limits_ = limits;
  if (std::isfinite(limits.edges)) longest_.resize(mesh_.vertex_count(), 0);
  is_cut_ = !places_.empty() && !barriers_.empty();
  do {
    while (queue_.advance() && queue_.reached() <= limits_.radius) {
      if (report) report(queue_.reached(), static_cast<Index>(reached_.size()));
      while (auto* const block = queue_.take()) drain(block, stage);
      // Last in the bucket: by now their distances are final, nearly always.
      for (const Index vertex : due_) bend(vertex);
      due_.clear();
    }
  } while (cover_again(stage));
  std::ranges::copy_if(reached_, std::back_inserter(settled_),
                       [this](Index vertex) { return distances_[vertex] <= limits_.radius; });
}

/// Tells whether some vertex is farther than by an edge from its neighbor: see ExactPropagation::cover_again.
bool WavefrontDistances::cover_again(const JobStage& stage) {
  if (std::isfinite(limits_.edges)) return false;  // rays stop on purpose
  for (const Index vertex : reached_) {
    stage.check();
    const auto look = [&](Index to, double length) {
      const double way = distances_[vertex] + length;
      if (way <= limits_.radius && way < distances_[to] * k_shorter) due_.push_back(vertex);
    };
    const Index first = mesh_.first_halfedge(vertex);
    Index h = first;
    do {
      const Index last = Mesh::prev(h);
      look(mesh_.to(h), mesh_.length(h));
      if (mesh_.twin(last) == k_none) look(mesh_.from(last), mesh_.length(last));
      h = mesh_.rotate(h);
    } while (h != k_none && h != first);
  }
  if (due_.empty()) return false;
  queue_.clear();
  due_.erase(std::unique(due_.begin(), due_.end()), due_.end());
  for (const Index vertex : std::exchange(due_, {})) emit_from(vertex, 0, mesh_.total_angle(vertex));
  return true;
}

/// Propagates a chain of blocks.
void WavefrontDistances::drain(BlockQueue<RayWindow>::Block* block, const JobStage& stage) {
  while (block) {
    stage.check();
    for (Index i = 0; i < block->size; ++i) {
      const RayWindow& window = block->items[i];
      if (window.halfedge < 0) {
        const Index vertex = ~window.halfedge;
        if (distances_[vertex] == window.offset) due_.push_back(vertex);
        continue;
      }
      if (is_cut_) reach_before_barriers(window);
      barriers_.for_each_free_part(window, RayBarriers::Side::entered, [this](const RayWindow& part) {
        part.rays == Rays::perpendicular ? propagate<Parallel>(part) : propagate<Radial>(part);
      });
    }
    auto* const next = block->next;
    queue_.give_back(block);
    block = next;
  }
}

double WavefrontDistances::angle_back(Index vertex) const {
  const VertexState& v = vertices_[vertex];
  if (v.halfedge == k_none) return v.ray.x();
  const Vec2& apex = unfolding_.apex(v.halfedge);
  const Index leaving = Mesh::prev(v.halfedge);
  const double angle = std::atan2(cross(apex, v.ray), apex.dot(v.ray));
  return unfolding_.polar(leaving) + std::clamp(angle, 0.0, mesh_.corner_angle(leaving));
}

/// A shortest path may go on from a saddle vertex in any direction that leaves at least pi on either side.
void WavefrontDistances::bend(Index vertex) {
  VertexState& v = vertices_[vertex];
  if (v.is_source || v.bent_at <= v.label.distance || v.label.distance > limits_.radius) return;
  v.bent_at = v.label.distance;
  const double total = mesh_.total_angle(vertex), back = angle_back(vertex);
  if (mesh_.is_boundary(vertex)) {
    if (back - k_pi >= -k_flat) emit_from(vertex, 0, back - k_pi);
    if (back + k_pi <= total + k_flat) emit_from(vertex, back + k_pi, total);
  } else if (total > 2 * k_pi + k_flat) {
    const double begin = back + k_pi, end = back + total - k_pi;
    emit_from(vertex, begin, std::min(end, total));
    if (end > total) emit_from(vertex, std::max(0.0, begin - total), end - total);
  }
}

void WavefrontDistances::emit_from(Index vertex, double begin, double end) {
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

/// Tells whether the rays have gone all round a tip: see tips.h. Those of a curve that is at the tip itself have only
/// begun.
template <class Front>
bool WavefrontDistances::circles_tip(const RayWindow& w) const {
  const double length = mesh_.length(w.halfedge);
  const Tip &at_from = tips_[mesh_.from(w.halfedge)], &at_to = tips_[mesh_.to(w.halfedge)];
  const auto comes_from_afar = [&](double b) {
    return !Front::is_parallel || Front::distance(w, b) > k_at_border * length;
  };
  const Vec2 to_start = Front::ray(w, Vec2(w.b0, 0)), to_end = Front::ray(w, Vec2(w.b1, 0));
  if (w.b1 == length && circles(at_to.tangent, to_end.x(), to_end.y()) && comes_from_afar(length)) return true;
  if (w.b0 == 0 && circles(at_from.tangent, -to_start.x(), to_start.y()) && comes_from_afar(0)) return true;
  const auto root = [&](double b) { return Front::is_parallel ? Front::distance(w, b) : 1; };  // in units of the ray
  const auto circles_with = [&](const Tip& tip, double from_b0, double from_b1, double towards) {
    return circles_near(tip, from_b0, {towards * to_start.x(), to_start.y()}, root(w.b0)) &&
           circles_near(tip, from_b1, {towards * to_end.x(), to_end.y()}, root(w.b1));
  };
  return circles_with(at_to, length - w.b0, length - w.b1, 1) || circles_with(at_from, w.b0, w.b1, -1);
}

/// Barriers take rays that meet them in the face out of a window; places before them see those rays all the same.
void WavefrontDistances::reach_before_barriers(const RayWindow& window) {
  window.rays == Rays::perpendicular ? reach_places<Parallel>(window) : reach_places<Radial>(window);
}

template <class Front>
void WavefrontDistances::propagate(const RayWindow& window) {
  const Index h = window.halfedge;
  const double base = mesh_.length(h);
  const Vec2& apex = unfolding_.apex(h);
  const double at_from = distances_[mesh_.from(h)] * k_slack, at_to = distances_[mesh_.to(h)] * k_slack;
  if (Front::is_less(at_from + window.b1, window, window.b1) ||
      Front::is_less(at_to + (base - window.b0), window, window.b0))
    return;
  if (!tips_.empty() && circles_tip<Front>(window)) return;
  const Vec2 ray = Front::ray(window, apex);
  if (ray.y() <= 0) return;  // grazes the edge: only rounding brings it here
  if (!places_.empty() && !is_cut_) reach_places<Front>(window);
  const double reach = Front::distance(window, ray, apex);
  // Where the ray to the apex crosses the half-edge.
  const double split = apex.x() - ray.x() * (apex.y() / ray.y());
  const double nearest = std::clamp(split, window.b0, window.b1);
  const auto is_within = [&](double share, double b) { return Front::is_within(share, window, base, b, split); };
  if (split == nearest || is_within(k_miss, nearest)) reach_apex<Front>(window, ray, split, reach);
  const double wide = Front::wide(window, base);
  const auto is_wide = [&](double b) {
    return Front::area(window, std::abs(split - b)) > wide || !is_within(k_narrow, b);
  };
  const bool has_left = split > window.b0 && is_wide(window.b0), has_right = split < window.b1 && is_wide(window.b1);
  bool go_left = has_left, go_right = has_right;
  if (has_left && has_right) {
    Occupant& occupant = occupants_[h];
    if (occupant.epoch != epoch_ || reach < occupant.distance * k_shorter) {
      occupant = {reach, split, epoch_};
    } else if (!is_within(k_miss, occupant.split)) {
      // A nearer window has split this angle: behind its ray everything is nearer by the other one. (The same ray, of
      // neighbors that overlap or pieces of a curve that lie on each other, hides nothing.)
      go_left = split < occupant.split;
      go_right = !go_left;
    }
  }
  const double at_apex = distances_[mesh_.apex(h)] * k_slack;
  if (go_left)
    add_child<Front>(window, {true, Mesh::prev(h), at_from, at_to, at_apex}, window.b0, std::min(window.b1, split),
                     has_right);
  if (go_right)
    add_child<Front>(window, {false, Mesh::next(h), at_to, at_from, at_apex}, base - window.b1,
                     base - std::max(window.b0, split), has_left);
}

template <class Front>
void WavefrontDistances::reach_apex(const RayWindow& window, const Vec2& ray, double split, double reach) {
  const Index h = window.halfedge;
  const Vec2& apex = unfolding_.apex(h);
  if (const double b = std::clamp(split, window.b0, window.b1); b != split)
    reach = Front::distance(window, b) + length_of(apex.x() - b, apex.y());
  if (!improves(mesh_.apex(h), reach, window.shadowed)) return;
  RayLabel label{reach, window.value, window.side, window.shadowed};
  if (window.rays == Rays::from_point) label.value += std::atan2(ray.y(), ray.x());
  if (Front::is_parallel) label.value += tangent(window).dot(apex);
  improve(mesh_.apex(h), label, ray, h);
}

/// Reaches, of the places in the face that the window enters those that its rays meet.
template <class Front>
void WavefrontDistances::reach_places(const RayWindow& window) {
  const Index h = window.halfedge;
  const double base = mesh_.length(h), begin = window.b0 - k_at_border * base, end = window.b1 + k_at_border * base;
  const Vec2 apex = unfolding_.apex(h);
  const auto to = static_cast<int>(Mesh::next(h) % 3), opposite = static_cast<int>(Mesh::prev(h) % 3);
  const std::span<const double> known = places_.values();
  places_.places().in_face(Mesh::face_of(h), [&](Index index, const Vec3& weights) {
    const Vec2 place(weights[to] * base + weights[opposite] * apex.x(), weights[opposite] * apex.y());
    const Vec2 ray = Front::ray(window, place);
    if (ray.y() <= 0) return;
    // Where the ray crosses the half-edge, times ray.y().
    const double crossing = place.x() * ray.y() - ray.x() * place.y();
    if (crossing < begin * ray.y() || crossing > end * ray.y()) return;
    const double distance = Front::distance(window, ray, place);
    if (distance >= known[index]) return;
    places_.offer(index, distance, window.value + (window.rays == Rays::from_point ? std::atan2(ray.y(), ray.x()) : 0));
  });
}

/// Makes the part of `parent` between `begin` and `end` (coordinates of the side) emit on the side's edge, unless some
/// corner of the face offers every point of it a shorter way: the three filters of Xin and Wang [xin2009]. They hold
/// for perpendicular rays as well: all they need is that nothing is nearer than the rays say.
template <class Front>
void WavefrontDistances::add_child(const RayWindow& parent, const Side& side, double begin, double end, bool to_apex) {
  const Index entered = mesh_.twin(side.edge);
  if (entered == k_none) return;
  const double base = mesh_.length(parent.halfedge), length = mesh_.length(side.edge), to_unit = 1 / length;
  const Vec2& apex = unfolding_.apex(parent.halfedge);
  RayWindow child = parent;  // at first in the side's coordinates
  double sx = parent.source.x(), ux = apex.x() * to_unit;
  const double sy = parent.source.y(), uy = apex.y() * to_unit;
  if (!side.left) {  // the mirror image
    ux = unfolding_.to_end(parent.halfedge) * to_unit;
    if (Front::is_parallel) child.offset += sx * base;
    sx = Front::is_parallel ? -sx : base - sx;
  }
  const auto hit = [&](double b) {  // where the ray through (b, 0) meets the edge, measured from the near vertex
    const double rx = Front::is_parallel ? sx : b - sx, ry = Front::is_parallel ? sy : -sy;
    const double divisor = ux * ry - uy * rx;
    return divisor > 0 ? std::min(b * ry / divisor, length) : length;
  };
  child.halfedge = entered;
  child.b0 = hit(std::max(begin, 0.0));
  child.b1 = to_apex ? length : hit(end);
  child.source = {sx * ux + sy * uy, ux * sy - uy * sx};
  if (!Front::is_parallel) child.source.y() = std::min(0.0, child.source.y());
  if (Front::is_parallel && child.source.y() <= 0) return;
  Front::widen(child, length);
  const double q0 = child.b0, q1 = child.b1;
  if (!(q1 > q0)) return;
  if (Front::is_less(side.at_near + q1, child, q1)) return;
  if (Front::is_less(side.at_apex + (length - q0), child, q0)) return;
  if (Front::is_less(side.at_far + length_of(base - q0 * ux, q0 * uy), child, q0)) return;
  const double key = Front::least(child);
  if (is_too_far(child, key)) return;
  queue_.push(seen_from_side<Front>(parent, child, side), key);
}

/// The child, which is in the side's coordinates, in the frame of the half-edge that it enters.
template <class Front>
RayWindow WavefrontDistances::seen_from_side(const RayWindow& parent, RayWindow child, const Side& side) const {
  const Index h = parent.halfedge;
  if (side.left) {
    if (parent.rays == Rays::from_point) child.value += mesh_.corner_angle(h);
    return child;
  }
  const double length = mesh_.length(side.edge);
  child.b0 = length - std::exchange(child.b1, length - child.b0);
  if (Front::is_parallel) {
    const Vec2& apex = unfolding_.apex(h);
    child.source.x() = -child.source.x();
    child.offset = parent.offset + parent.source.dot(apex);
    child.value += tangent(parent).dot(apex);
  } else {
    child.source.x() = length - child.source.x();
    if (parent.rays == Rays::from_point) child.value -= mesh_.corner_angle(Mesh::next(h));
  }
  return child;
}

}  // namespace saddleback
