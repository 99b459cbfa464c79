#include "voronoi2d/diagram/diagram_sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "saddleback/error.h"

#include "voronoi2d/diagram/edge_curve.h"

namespace saddleback::voronoi2d {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
constexpr double k_turn = 2 * std::numbers::pi;

Vec2 direction_at(double angle) { return {std::cos(angle), std::sin(angle)}; }

double weight_of(const Voronoi2d& diagram, Index site) { return diagram.weights.empty() ? 0 : diagram.weights[site]; }

}  // namespace

Voronoi2d weighted_diagram(std::span<const Vec2> sites, std::span<const double> weights, Job* job) {
  Voronoi2d diagram = weights.empty() ? voronoi_2d(sites, {}, job) : voronoi_2d(sites, weights, {}, job);
  diagram.weights.assign(weights.begin(), weights.end());
  return diagram;
}

void check_samples(Index samples) {
  constexpr Index k_most = 100'000;
  if (samples < 1 || samples > k_most) throw InputError(message("samples: wanted 1 to ", k_most, ", got ", samples));
}

DiagramSweep::DiagramSweep(const Voronoi2d& diagram, const Vec2& center, const JobStage& stage)
    : diagram_(diagram), center_(center), touches_(diagram.sites.size(), k_infinity), lasts_(diagram.sites.size(), 0) {
  for (const Index site : diagram.cell_sites) {
    touches_[site] = (diagram.sites[site] - center).norm() - weight_of(diagram, site);
    lasts_[site] = diagram.is_bounded(site) ? touches_[site] : k_infinity;
    events_.push_back({true, touches_[site], {site}, diagram.sites[site]});
  }
  add_vertices(stage);
  std::sort(events_.begin(), events_.end(), [&](const Event& a, const Event& b) {
    stage.check();
    if (a.radius != b.radius) return a.radius < b.radius;
    return a.is_touch != b.is_touch ? a.is_touch : a.sites < b.sites;
  });
}

void DiagramSweep::add_vertices(const JobStage& stage) {
  vertex_radii_.assign(diagram_.vertices.size(), k_infinity);
  for (std::size_t corner = 0; corner < diagram_.corner_vertices.size(); ++corner) {
    const Index vertex = diagram_.corner_vertices[corner];
    if (vertex == k_none || vertex_radii_[vertex] < k_infinity) continue;
    stage.check();
    Event event{false, 0, {}, diagram_.vertices[vertex]};
    diagram_.sites_around(vertex, diagram_.side_edges[corner], event.sites);
    const Index site = event.sites[0];
    event.radius =
        (event.point - center_).norm() + (event.point - diagram_.sites[site]).norm() - weight_of(diagram_, site);
    vertex_radii_[vertex] = event.radius;
    for (const Index around : event.sites) lasts_[around] = std::max(lasts_[around], event.radius);
    events_.push_back(std::move(event));
  }
}

// Seen from the left site, half the reciprocals of the distances of the edge's curve and of the ellipse are linear in
// the direction: the curve is within the ellipse between the two directions where they are equal. When a site is
// touched its ellipse is the way from there to the center.
std::optional<std::array<double, 2>> DiagramSweep::parameters_within(Index edge, const Bisector& curve,
                                                                     double radius) const {
  const auto [left, right] = diagram_.edge_sites[edge];
  const Vec2 &site = diagram_.sites[left], way = diagram_.sites[right] - site, to_center = center_ - site;
  const double e = weight_of(diagram_, right) - weight_of(diagram_, left), n = way.squaredNorm() - e * e;
  if (radius <= touches_[left] || radius <= touches_[right]) {
    const bool is_left = touches_[left] > touches_[right];
    const Vec2& touched = diagram_.sites[is_left ? left : right];
    const Vec2 u = (center_ - touched).stableNormalized();
    const double rest = is_left ? way.dot(u) + e : -way.dot(u) - e;
    if (!(rest > 0)) return std::nullopt;
    const double place = curve.parameter(touched + 0.5 * n / rest * u - site);
    return std::array{place, place};
  }
  const double length = radius + weight_of(diagram_, left), m = length * length - to_center.squaredNorm();
  const Vec2 slope = way / n + to_center / m;
  const double offset = e / n - length / m, size = slope.norm();
  if (!(m > 0) || !(std::fabs(offset) < size)) return std::nullopt;
  const double middle = std::atan2(slope.y(), slope.x()), half = std::acos(-offset / size);
  const auto parameter_at = [&](double angle) {
    const Vec2 u = direction_at(angle);
    return curve.parameter(m / (2 * (length - to_center.dot(u))) * u);
  };
  return std::array{parameter_at(middle - half), parameter_at(middle + half)};
}

// Which vertices have been found is known from their events, so that an edge between such is finished, and one from
// such has begun, whatever rounding makes of the rest.
std::optional<DiagramSweep::Part> DiagramSweep::part_within(Index edge, double radius) const {
  const auto [left, right] = diagram_.edge_sites[edge];
  const auto [first, last] = diagram_.edges[edge];
  const auto is_found = [&](Index vertex) { return vertex != k_none && vertex_radii_[vertex] <= radius; };
  const bool has_first = is_found(first), has_last = is_found(last);
  if (!has_first && !has_last && (radius < touches_[left] || radius < touches_[right])) return std::nullopt;
  const Bisector curve = bisector_beside(diagram_, left, edge);
  const Vec2& site = diagram_.sites[left];
  const double begin = first == k_none ? -k_infinity : curve.parameter(diagram_.vertices[first] - site);
  const double end = last == k_none ? k_infinity : curve.parameter(diagram_.vertices[last] - site);
  if (has_first && has_last) return Part{edge, begin, end, false, false};
  const std::optional<std::array<double, 2>> within = parameters_within(edge, curve, radius);
  if (has_first) return Part{edge, begin, within ? std::clamp((*within)[1], begin, end) : begin, false, true};
  if (has_last) return Part{edge, within ? std::clamp((*within)[0], begin, end) : end, end, true, false};
  if (!within || (*within)[1] < begin || (*within)[0] > end) return std::nullopt;
  return Part{edge, std::max(begin, (*within)[0]), std::min(end, (*within)[1]), true, true};
}

template <class Visit>
void DiagramSweep::for_parts(double radius, Visit&& visit) const {
  for (std::size_t edge = 0; edge < diagram_.edges.size(); ++edge)
    if (const auto part = part_within(static_cast<Index>(edge), radius)) visit(*part);
}

/// Returns the ends: to the bit the vertices that have been found.
std::array<Vec2, 2> DiagramSweep::ends(const Part& part, const Bisector& curve) const {
  const auto [first, last] = diagram_.edges[part.edge];
  return {part.grows_from ? curve.at(part.from) : diagram_.vertices[first],
          part.grows_to ? curve.at(part.to) : diagram_.vertices[last]};
}

std::vector<DiagramSweep::Edge> DiagramSweep::edges(double radius) const {
  std::vector<Edge> result;
  for_parts(radius, [&](const Part& part) {
    const auto [begin, end] = ends(part, edge_bisector(diagram_, part.edge));
    Edge edge{begin, end, diagram_.edge_sites[part.edge], !part.grows_from && !part.grows_to};
    if (!part.grows_to && part.grows_from) std::swap(edge.begin, edge.end);
    result.push_back(edge);
  });
  return result;
}

std::vector<std::vector<Vec2>> DiagramSweep::polylines(double radius, double tolerance) const {
  constexpr double k_finest = 0x1p-26;  // some thousands of points an edge
  std::vector<std::vector<Vec2>> result;
  for_parts(radius, [&](const Part& part) {
    const Bisector curve = edge_bisector(diagram_, part.edge);
    const auto [begin, end] = ends(part, curve);
    std::vector<Vec2> points{begin};
    curve.sample(part.from, part.to, std::max(tolerance, k_finest * radius), points);
    points.push_back(end);
    if (!part.grows_to && part.grows_from) std::reverse(points.begin(), points.end());
    result.push_back(std::move(points));
  });
  return result;
}

/// Returns how far from the center a site's ellipse lies.
std::optional<double> DiagramSweep::reach(Index site, double radius, const Vec2& direction) const {
  const Vec2 to_site = diagram_.sites[site] - center_;
  const double length = radius + weight_of(diagram_, site), m = length * length - to_site.squaredNorm();
  if (!(length > 0) || !(m >= 0)) return std::nullopt;
  const double rest = length - to_site.dot(direction);
  return rest > 0 ? 0.5 * m / rest : 0;
}

std::vector<Index> DiagramSweep::sites_on_beach(double radius) const {
  std::vector<Index> result;
  for (const Index site : diagram_.cell_sites)
    if (touches_[site] <= radius && lasts_[site] >= radius) result.push_back(site);
  return result;
}

std::vector<Vec2> DiagramSweep::beach_curve(double radius, Index samples) const {
  const std::vector<Index> sites = sites_on_beach(radius);
  std::vector<Vec2> result;
  for (Index k = 0; k < samples && !sites.empty(); ++k) {
    const Vec2 direction = direction_at(k_turn * k / samples);
    double farthest = 0;
    for (const Index site : sites) farthest = std::max(farthest, reach(site, radius, direction).value_or(0));
    result.push_back(center_ + farthest * direction);
  }
  return result;
}

// Arcs end at the tips of growing edges; between two tips one of their sites is the farthest out.
std::vector<DiagramSweep::Arc> DiagramSweep::arcs(double radius) const {
  struct Tip {
    double angle;
    std::array<Index, 2> sites;
  };
  std::vector<Tip> tips;
  for_parts(radius, [&](const Part& part) {
    const Bisector curve = edge_bisector(diagram_, part.edge);
    const auto add = [&](double t) {
      const Vec2 tip = curve.at(t) - center_;
      tips.push_back({std::atan2(tip.y(), tip.x()), diagram_.edge_sites[part.edge]});
    };
    if (part.grows_from) add(part.from);
    if (part.grows_to) add(part.to);
  });
  std::sort(tips.begin(), tips.end(), [](const Tip& a, const Tip& b) { return a.angle < b.angle; });
  const auto farthest = [&](double angle, const auto& sites) {
    return *std::max_element(sites.begin(), sites.end(), [&](Index a, Index b) {
      const Vec2 u = direction_at(angle);
      return reach(a, radius, u).value_or(-1) < reach(b, radius, u).value_or(-1);
    });
  };
  std::vector<Arc> result;
  const std::vector<Index> sites = tips.empty() ? sites_on_beach(radius) : std::vector<Index>();
  if (!sites.empty()) result.push_back({farthest(0, sites), 0, k_turn});
  for (std::size_t k = 0; k < tips.size(); ++k) {
    const Tip &from = tips[k], &to = tips[k + 1 == tips.size() ? 0 : k + 1];
    const double end = k + 1 == tips.size() ? to.angle + k_turn : to.angle;
    const std::array<Index, 4> about{from.sites[0], from.sites[1], to.sites[0], to.sites[1]};
    result.push_back({farthest(0.5 * (from.angle + end), about), from.angle, end});
  }
  return result;
}

}  // namespace saddleback::voronoi2d
