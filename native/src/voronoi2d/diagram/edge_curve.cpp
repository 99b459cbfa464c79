#include "voronoi2d/diagram/edge_curve.h"

#include <algorithm>
#include <cmath>

#include "saddleback/error.h"

namespace saddleback::voronoi2d {
namespace {

// Halves and a largest component of 1 keep squares among the doubles.
Vec2 direction_between(const Vec2& a, const Vec2& b) {
  Vec2 way = 0.5 * b - 0.5 * a;
  if (way.isZero(0)) way = b - a;
  way /= way.cwiseAbs().maxCoeff();
  return way.normalized();
}

}  // namespace

Vec2 middle_between(const Voronoi2d& diagram, Index a, Index b) {
  const Vec2 &at_a = diagram.sites[a], &at_b = diagram.sites[b];
  Vec2 middle = 0.5 * at_a + 0.5 * at_b;
  if (diagram.powers.empty()) return middle;
  const Vec2 way = at_b - at_a;
  const double length = way.stableNorm();
  return middle + 0.5 * ((diagram.powers[a] - diagram.powers[b]) / length) * (way / length);
}

WeightedPoint2 weighted_site(const Voronoi2d& diagram, Index site) {
  const Vec2& place = diagram.sites[site];
  return {place.x(), place.y(), diagram.weights.empty() ? 0 : diagram.weights[site]};
}

Bisector edge_bisector(const Voronoi2d& diagram, Index edge) {
  const auto [left, right] = diagram.edge_sites[edge];
  return {weighted_site(diagram, left), weighted_site(diagram, right)};
}

Bisector bisector_beside(const Voronoi2d& diagram, Index site, Index edge) {
  const auto [left, right] = diagram.edge_sites[edge];
  const Index other = left == site ? right : left;
  return {weighted_site(diagram, site), weighted_site(diagram, other), diagram.sites[site]};
}

namespace {

void add_power_edge(const Voronoi2d& diagram, Index edge, double extent, std::vector<Vec2>& points) {
  const auto [left, right] = diagram.edge_sites[edge];
  const Vec2 middle = middle_between(diagram, left, right),
             across = direction_between(diagram.sites[left], diagram.sites[right]), along(-across.y(), across.x());
  const auto [first, second] = diagram.edges[edge];
  const auto place = [&](Index vertex) { return (diagram.vertices[vertex] - middle).dot(along); };
  const double from = first == k_none ? 0 : place(first);
  points.push_back(first == k_none ? Vec2(middle - extent * along) : diagram.vertices[first]);
  points.push_back(second == k_none ? Vec2(middle + (std::max(from, 0.0) + extent) * along) : diagram.vertices[second]);
}

}  // namespace

EdgePart edge_part(const Voronoi2d& diagram, Index edge, const Bisector& curve, double extent) {
  const Vec2 apex = curve.at(0);
  const auto end = [&](Index vertex, bool is_forwards) -> EdgePart::End {
    if (vertex != k_none) {
      const Vec2& place = diagram.vertices[vertex];
      const double t = curve.parameter(place);
      if ((place - apex).stableNorm() <= extent) return {t, false};
      is_forwards = t > 0;
    }
    return {curve.parameter_beyond(0, is_forwards, extent), true};
  };
  const auto [first, second] = diagram.edges[edge];
  return {end(first, false), end(second, true)};
}

void add_edge_points(const Voronoi2d& diagram, Index edge, double tolerance, double extent, std::vector<Vec2>& points) {
  if (!diagram.powers.empty()) return add_power_edge(diagram, edge, extent, points);
  const Bisector curve = edge_bisector(diagram, edge);
  const auto [first, second] = diagram.edges[edge];
  const double from =
      first == k_none ? curve.parameter_beyond(0, false, extent) : curve.parameter(diagram.vertices[first]);
  const double to = second == k_none ? curve.parameter_beyond(first == k_none ? 0 : from, true, extent)
                                     : curve.parameter(diagram.vertices[second]);
  points.push_back(first == k_none ? curve.at(from) : diagram.vertices[first]);
  curve.sample(from, to, tolerance, points);
  points.push_back(second == k_none ? curve.at(to) : diagram.vertices[second]);
}

}  // namespace saddleback::voronoi2d

namespace saddleback {

using namespace voronoi2d;

std::vector<Vec2> Voronoi2d::edge_directions() const {
  std::vector<Vec2> result;
  result.reserve(edges.size());
  for (std::size_t edge = 0; edge < edges.size(); ++edge) {
    const auto [left, right] = edge_sites[edge];
    const auto [first, second] = edges[edge];
    const bool is_curved = !weights.empty();
    if (is_curved && first != k_none && second == k_none) {
      result.push_back(edge_bisector(*this, static_cast<Index>(edge)).end_direction(true));
    } else if (is_curved && first != k_none && vertices[first] != vertices[second]) {
      result.push_back(direction_between(vertices[first], vertices[second]));
    } else {
      const Vec2 across = direction_between(sites[left], sites[right]);
      result.emplace_back(-across.y(), across.x());
    }
  }
  return result;
}

std::vector<Vec2> Voronoi2d::edge_polyline(Index edge, double tolerance, double extent) const {
  if (edge < 0 || edge >= static_cast<Index>(edges.size()))
    throw InputError(message("edge: wanted 0 to ", static_cast<Index>(edges.size()) - 1, ", got ", edge));
  if (!(tolerance > 0)) throw InputError(message("tolerance: wanted a positive length, got ", tolerance));
  if (!(extent >= 0) || !std::isfinite(extent))
    throw InputError(message("extent: wanted a finite length, 0 or more, got ", extent));
  const auto [left, right] = edge_sites[edge];
  if (extent == 0) extent = 2 * (sites[right] - sites[left]).stableNorm();
  std::vector<Vec2> points;
  add_edge_points(*this, edge, tolerance, extent, points);
  return points;
}

}  // namespace saddleback
