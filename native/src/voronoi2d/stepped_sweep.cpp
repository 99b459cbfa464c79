// The ellipse |x - c| + |x - s| = R about the center c and a site s lies at the distance w / (2 (R - s.u)) in direction
// u, with w = R^2 - |s|^2 and s counted from c. Two of them are equally far where m.u = R (w' - w), m = s w' - s' w.

#include "saddleback/voronoi2d/stepped_sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

#include "saddleback/error.h"
#include "saddleback/job.h"

#include "support/hypotenuse.h"
#include "voronoi2d/diagram/circumcenter.h"
#include "voronoi2d/diagram/diagram_sweep.h"
#include "voronoi2d/sites/site_order.h"
#include "voronoi2d/sweep/planar_mesh.h"
#include "voronoi2d/sweep/sweep_step.h"

namespace saddleback {

using namespace voronoi2d;

namespace {

/// A sweep told from the diagram: of weighted sites, and of the rare ones that no sweep in doubles gets through.
struct ToldSweep {
  Voronoi2d diagram;
  DiagramSweep sweep;
  std::size_t next = 0;  ///< event
  ToldSweep(std::span<const Vec2> sites, const Vec2& center, std::span<const double> weights, Job* job)
      : diagram(weighted_diagram(sites, weights, job)), sweep(diagram, center, JobStage(job, "Sweeping")) {}
};

/// Holds what a sweep has come to.
struct Progress {
  /// An arc vanishes.
  struct Vanishing {
    double radius;
    Index arc;
    bool operator>(const Vanishing& other) const { return radius > other.radius; }
  };

  std::vector<voronoi2d::Arc> arcs;
  std::vector<Vanishing> vanishing;  ///< a heap, the soonest first; out of date where the arc has another radius
  std::vector<Index> near, triangles, twins;
  SweepState sweep{};
  Index touched = 0;  ///< sites
  Index untold = 0;   ///< triangles about the center, where that is a vertex, whose events are still to be told

  /// To be called when it was copied.
  void attach() {
    sweep.arcs = arcs.data();
    sweep.near = near.data();
    sweep.triangles = triangles.data();
    sweep.twins = twins.data();
  }
};

}  // namespace

struct SteppedSweep::State : Progress {
  std::unique_ptr<ToldSweep> told;  ///< then only `center` and `radius` are used of the rest
  bool is_checked = false;          ///< whether `told` is known to be needed or not
  std::vector<Vec2> given;          ///< sites
  OrderedSites ordered;
  std::vector<double> x, y, radii;  ///< from near to far
  std::vector<Index> original;
  Vec2 center;
  double radius = 0;
  Index nearest = 0;  ///< how many sites are equally near and nearest

  void sort_sites(const Vec2& scaled_center);
  void start_sweep();
  bool is_triangulation() const;
  SweptSite swept(Index k) const { return {x[k], y[k], k}; }
  bool is_started() const { return touched >= std::max<Index>(1, nearest < 3 ? 1 : nearest); }
  double next_touch() const { return touched < static_cast<Index>(x.size()) ? radii[touched] : k_never; }
  Index touch_next();
  void reach(double event_radius);
  void run(double up_to, const JobStage& stage);
  void check(double wanted, Job* job);
  void note(Index arc);
  double vanish_next(double up_to);
  Vec2 site(Index k) const { return {x[k] - sweep.center_x, y[k] - sweep.center_y}; }
  Vec2 outside(const Vec2& from_center) const { return center + from_center / ordered.scale; }
  double scaled_radius() const { return radius * ordered.scale; }
  double weight(Index k) const { return (scaled_radius() - radii[k]) * (scaled_radius() + radii[k]); }
  Vec2 point_in(Index k, const Vec2& direction) const;
  double breakpoint(const voronoi2d::Arc& arc) const;
  Vec2 vertex(Index triangle) const;
  Event vanished(Index triangle) const;
  template <class Visit>
  void for_each_arc(Visit&& visit) const;
};

// From near to far; of the nearest ones, if there are several, counter-clockwise.
void SteppedSweep::State::sort_sites(const Vec2& scaled_center) {
  const Index count = ordered.count();
  std::vector<Index> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::vector<double> distances(count);
  for (Index i = 0; i < count; ++i)
    distances[i] = hypotenuse(ordered.x[i] - scaled_center.x(), ordered.y[i] - scaled_center.y());
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return distances[a] != distances[b] ? distances[a] < distances[b] : a < b; });
  const auto point = [&](Index i) { return predicates::Point2{ordered.x[i], ordered.y[i]}; };
  const predicates::Point2 c{scaled_center.x(), scaled_center.y()};
  nearest = count > 0;
  while (nearest < count &&
         predicates::compare_distances(c, point(order[0]), point(order[nearest])) == predicates::Sign::zero)
    ++nearest;
  const auto angle = [&](Index i) { return std::atan2(ordered.y[i] - c.y, ordered.x[i] - c.x); };
  std::sort(order.begin(), order.begin() + nearest, [&](Index a, Index b) { return angle(a) < angle(b); });
  for (const Index i : order) {
    x.push_back(ordered.x[i]);
    y.push_back(ordered.y[i]);
    radii.push_back(distances[i]);
    original.push_back(ordered.original[i]);
  }
}

void SteppedSweep::State::start_sweep() {
  const std::size_t count = x.size();
  touched = untold = 0;
  vanishing.clear();
  arcs.resize(2 * count);
  near.resize(256);
  triangles.resize(8 * count);
  twins.resize(8 * count);
  sweep = {.center_x = sweep.center_x,
           .center_y = sweep.center_y,
           .arcs = arcs.data(),
           .near = near.data(),
           .near_count = static_cast<Index>(near.size()),
           .triangles = triangles.data(),
           .twins = twins.data()};
}

/// Tells of a finished sweep whether rounding has led it astray. Triangles turn counter-clockwise and are joined, and
/// no arc is left whose site lies within the border: if that turns once they are a triangulation. Exact.
bool SteppedSweep::State::is_triangulation() const {
  const auto goes_up = [&](Index arc) {
    const voronoi2d::Arc &from = sweep.arcs[arc], &to = sweep.arcs[from.next];
    return to.y > from.y || (to.y == from.y && to.x > from.x);
  };
  if (x.size() < 2) return true;
  Index changes = 0, arc = sweep.latest;
  do {
    changes += goes_up(arc) != goes_up(sweep.arcs[arc].next);
    arc = sweep.arcs[arc].next;
  } while (arc != sweep.latest);
  return changes == 2;
}

/// Touches the next site; of several that are nearest all with the last of them. Here events are in the order of the
/// radius, so that no arc is overdue when a site is touched.
Index SteppedSweep::State::touch_next() {
  const Index site = touched++;
  if (nearest >= 3 && touched <= nearest) {
    if (touched < nearest) return site;
    std::vector<SweptSite> all;
    for (Index k = 0; k < nearest; ++k) all.push_back(swept(k));
    start_about_vertex(sweep, all.data(), nearest);
    untold = sweep.triangle_count;
  } else if (site == 0) {
    start(sweep, swept(0));
  } else {
    const Index arc = touch(sweep, swept(site), -1);
    note(arcs[arc].previous);
    note(arcs[arc].next);
  }
  return site;
}

/// The circle has grown to an event; the last ones come at no radius of their own.
void SteppedSweep::State::reach(double event_radius) {
  if (event_radius < k_latest) radius = std::max(radius, event_radius / ordered.scale);
}

/// Goes through all events up to a radius.
void SteppedSweep::State::run(double up_to, const JobStage& stage) {
  while (true) {
    stage.check();
    const double vanished = is_started() ? vanish_next(std::min(up_to, next_touch())) : k_never;
    if (vanished != k_never) {
      reach(vanished);
    } else if (next_touch() <= up_to) {
      reach(next_touch());
      touch_next();
    } else {
      return;
    }
  }
}

/// Runs the sweep to its end before the first event is told, and then takes it back to `wanted`. Where rounding leads
/// it astray, events are told from the diagram.
void SteppedSweep::State::check(double wanted, Job* job) {
  const double before = radius;
  start_sweep();
  try {
    const JobStage stage(job, "Sweeping");
    run(wanted, stage);
    Progress then = *this;
    const double reached = radius;
    run(k_latest, stage);
    radius = reached;
    if (is_triangulation()) {
      static_cast<Progress&>(*this) = std::move(then);
      attach();
    } else {
      told = std::make_unique<ToldSweep>(given, center, std::span<const double>{}, job);
    }
  } catch (...) {
    radius = before;
    start_sweep();
    throw;
  }
  is_checked = true;
}

void SteppedSweep::State::note(Index arc) {
  if (arcs[arc].radius == k_never) return;
  vanishing.push_back({arcs[arc].radius, arc});
  std::push_heap(vanishing.begin(), vanishing.end(), std::greater<>());
}

/// Lets the arc vanish that does so first, if it does up to a radius: returns its radius, or else k_never.
double SteppedSweep::State::vanish_next(double up_to) {
  while (!vanishing.empty() && vanishing.front().radius <= up_to) {
    const Vanishing next = vanishing.front();
    std::pop_heap(vanishing.begin(), vanishing.end(), std::greater<>());
    vanishing.pop_back();
    if (arcs[next.arc].radius != next.radius) continue;
    const Index left = vanish(sweep, next.arc);
    note(left);
    note(arcs[left].next);
    return next.radius;
  }
  return k_never;
}

SteppedSweep::SteppedSweep(std::span<const Vec2> sites, const Vec2& center, std::span<const double> weights, Job* job)
    : state_(std::make_unique<State>()) {
  if (!center.allFinite())
    throw InputError(message("center: wanted finite numbers, got (", center.x(), ", ", center.y(), ")"));
  State& s = *state_;
  s.center = center;
  if (!weights.empty()) {
    s.told = std::make_unique<ToldSweep>(sites, center, weights, job);
    const auto& events = s.told->sweep.events();
    if (!events.empty()) s.radius = std::min(0.0, events[0].radius);
    return;
  }
  s.given.assign(sites.begin(), sites.end());
  s.ordered = order_sites(sites, 1, {});
  s.sweep.center_x = center.x() * s.ordered.scale;
  s.sweep.center_y = center.y() * s.ordered.scale;
  s.sort_sites({s.sweep.center_x, s.sweep.center_y});
  s.start_sweep();
}

SteppedSweep::~SteppedSweep() = default;
SteppedSweep::SteppedSweep(SteppedSweep&&) noexcept = default;
SteppedSweep& SteppedSweep::operator=(SteppedSweep&&) noexcept = default;

double SteppedSweep::radius() const { return state_->radius; }
const Vec2& SteppedSweep::center() const { return state_->center; }

bool SteppedSweep::is_begun() const { return state_->told || state_->is_checked; }

std::optional<SteppedSweep::Event> SteppedSweep::step(Job* job) {
  State& s = *state_;
  if (!is_begun()) s.check(-1, job);
  if (s.told) {
    const auto& events = s.told->sweep.events();
    if (s.told->next == events.size()) return std::nullopt;
    const Event& event = events[s.told->next++];
    s.radius = std::max(s.radius, event.radius);
    return event;
  }
  if (s.x.empty()) return std::nullopt;
  if (s.untold > 0) return s.vanished(s.sweep.triangle_count - s.untold--);
  if (s.is_started()) {
    const double radius = s.vanish_next(std::min(s.next_touch(), k_latest));
    if (radius != k_never) {
      s.reach(radius);
      return s.vanished(s.sweep.triangle_count - 1);
    }
  }
  if (s.next_touch() == k_never) return std::nullopt;
  s.reach(s.next_touch());
  const Index site = s.touch_next();
  return Event{true, s.radius, {s.original[site]}, s.outside(s.site(site))};
}

void SteppedSweep::grow(double radius, Job* job) {
  if (!std::isfinite(radius) || radius < 0)
    throw InputError(message("radius: wanted a finite number, 0 or more, got ", radius));
  State& s = *state_;
  const double scaled = std::min(radius * s.ordered.scale, k_latest);
  if (!is_begun()) s.check(scaled, job);
  if (s.told) {
    const auto& events = s.told->sweep.events();
    std::size_t& next = s.told->next;
    while (next < events.size() && events[next].radius <= radius) ++next;
    s.radius = std::max(s.radius, radius);
    return;
  }
  s.run(scaled, JobStage(job, "Sweeping"));
  if (radius >= s.radius) s.untold = 0;
  s.radius = std::max(s.radius, radius);
}

template <class Visit>
void SteppedSweep::State::for_each_arc(Visit&& visit) const {
  if (touched == 0 || (nearest >= 3 && touched < nearest)) return;
  Index arc = sweep.latest;
  do {
    visit(sweep.arcs[arc]);
    arc = sweep.arcs[arc].next;
  } while (arc != sweep.latest);
}

// A point of the ellipse about a site, counted from the center.
Vec2 SteppedSweep::State::point_in(Index k, const Vec2& direction) const {
  const double reach = scaled_radius() - site(k).dot(direction);
  return reach > 0 ? Vec2(weight(k) / (2 * reach) * direction) : Vec2(0, 0);
}

// Direction of the point where an arc meets the next one.
double SteppedSweep::State::breakpoint(const voronoi2d::Arc& arc) const {
  const Index i = arc.site, j = sweep.arcs[arc.next].site;
  const double wi = weight(i), wj = weight(j);
  const Vec2 m = site(i) * wj - site(j) * wi;
  const double length = m.norm();
  if (!(length > 0)) return std::atan2(site(j).y(), site(j).x());
  return std::atan2(m.y(), m.x()) + std::acos(std::clamp(scaled_radius() * (wj - wi) / length, -1.0, 1.0));
}

std::vector<SteppedSweep::Arc> SteppedSweep::arcs() const {
  const State& s = *state_;
  if (s.told) return s.told->sweep.arcs(s.radius);
  constexpr double k_turn = 2 * std::numbers::pi;
  std::vector<Arc> result;
  s.for_each_arc([&](const voronoi2d::Arc& arc) {
    Arc shown{s.original[arc.site], 0, k_turn};
    if (s.sweep.arcs[arc.next].site != arc.site) {
      shown.begin = s.breakpoint(s.sweep.arcs[arc.previous]);
      shown.end = s.breakpoint(arc);
      const double turns = std::floor((shown.end - shown.begin) / k_turn);
      shown.end -= turns * k_turn;
    }
    result.push_back(shown);
  });
  return result;
}

std::vector<Vec2> SteppedSweep::beach_curve(Index samples) const {
  voronoi2d::check_samples(samples);
  const State& s = *state_;
  if (s.told) return s.told->sweep.beach_curve(s.radius, samples);
  std::vector<Index> sites;
  s.for_each_arc([&](const voronoi2d::Arc& arc) { sites.push_back(arc.site); });
  std::vector<Vec2> result;
  for (Index k = 0; k < samples && !sites.empty(); ++k) {
    const double angle = 2 * std::numbers::pi * k / samples;
    const Vec2 direction(std::cos(angle), std::sin(angle));
    Vec2 farthest(0, 0);
    for (const Index site : sites) {
      const Vec2 point = s.point_in(site, direction);
      if (point.squaredNorm() > farthest.squaredNorm()) farthest = point;
    }
    result.push_back(s.outside(farthest));
  }
  return result;
}

Vec2 SteppedSweep::State::vertex(Index triangle) const {
  const auto point = [&](Index k) {
    return predicates::Point2{x[triangles[4 * triangle + k]], y[triangles[4 * triangle + k]]};
  };
  return circumcenter(point(0), point(1), point(2)) / ordered.scale;
}

SteppedSweep::Event SteppedSweep::State::vanished(Index triangle) const {
  std::vector<Index> sites;
  for (Index k = 0; k < 3; ++k) sites.push_back(original[triangles[4 * triangle + k]]);
  return {false, radius, std::move(sites), vertex(triangle)};
}

std::vector<SteppedSweep::Edge> SteppedSweep::edges() const {
  const State& s = *state_;
  if (s.told) return s.told->sweep.edges(s.radius);
  std::vector<Edge> result;
  for (Index half = 0; half < 4 * s.sweep.triangle_count; ++half) {
    if ((half & 3) == 3 || s.twins[half] < half) continue;
    const std::array<Index, 2> pair{s.original[s.triangles[half]], s.original[s.triangles[next_half(half)]]};
    result.push_back({s.vertex(half / 4), s.vertex(s.twins[half] / 4), pair, true});
  }
  const auto tip = [&](const voronoi2d::Arc& arc) {
    const double angle = s.breakpoint(arc);
    const Vec2 direction(std::cos(angle), std::sin(angle));
    const Index other = s.sweep.arcs[arc.next].site;
    return s.outside(s.point_in(s.weight(arc.site) > s.weight(other) ? arc.site : other, direction));
  };
  s.for_each_arc([&](const voronoi2d::Arc& arc) {
    const voronoi2d::Arc& next = s.sweep.arcs[arc.next];
    if (next.site == arc.site) return;
    const std::array<Index, 2> pair{s.original[arc.site], s.original[next.site]};
    if (arc.edge >= 0) {
      result.push_back({s.vertex(arc.edge / 4), tip(arc), pair, false});
    } else if (&s.sweep.arcs[~arc.edge] > &arc) {  // both ends grow: told once
      result.push_back({tip(s.sweep.arcs[~arc.edge]), tip(arc), pair, false});
    }
  });
  return result;
}

std::vector<std::vector<Vec2>> SteppedSweep::edge_polylines(double tolerance) const {
  if (!(tolerance > 0)) throw InputError(message("tolerance: wanted a positive length, got ", tolerance));
  if (state_->told) return state_->told->sweep.polylines(state_->radius, tolerance);
  std::vector<std::vector<Vec2>> result;
  for (const Edge& edge : edges()) result.push_back({edge.begin, edge.end});
  return result;
}

}  // namespace saddleback
