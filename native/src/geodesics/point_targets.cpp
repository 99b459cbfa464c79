#include "geodesics/point_targets.h"

#include <algorithm>
#include <limits>

#include "geodesics/line_of_sight.h"

namespace saddleback {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
// Room for rounding: no geodesic is shorter than the straight line.
constexpr double k_bird = 1 - 1e-12;

/// The shortest way over a vertex that both fans lead to, infinity when there is none.
double over_a_vertex(const PointFan& a, const PointFan& b) {
  double least = k_infinity;
  auto i = a.arcs.begin();
  auto j = b.arcs.begin();
  while (i != a.arcs.end() && j != b.arcs.end()) {
    if (i->vertex == j->vertex) least = std::min(least, i->length + j->length);
    ++(i->vertex < j->vertex ? i : j);
  }
  return least;
}

}  // namespace

double direct_length(const SaddleVertexGraph& graph, const SurfacePoint& a, const PointFan& a_fan,
                     const SurfacePoint& b, const PointFan& b_fan) {
  if (a_fan.is_vertex || b_fan.is_vertex) return k_infinity;
  const double around = over_a_vertex(a_fan, b_fan);
  if (around == k_infinity) return k_infinity;
  // The tighter the bound, the fewer windows: without, wide fans would end the search before it has seen the point.
  thread_local LineOfSight sight;
  const double length = sight.length(graph.unfolding(), a, b, around);
  return length < around ? length : k_infinity;
}

NearbySources::NearbySources(const SaddleVertexGraph& graph, const SurfacePoints& points,
                             std::span<const PointFan> fans)
    : graph_(graph), points_(points), fans_(fans) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    positions_.push_back(position(graph.mesh(), points[i]));
    if (fans[i].is_vertex) continue;  // seen by arcs of the target's fan
    for (const PointFan::Arc& arc : fans[i].arcs) entries_.push_back({arc.vertex, static_cast<Index>(i)});
  }
  std::ranges::sort(entries_);
}

double NearbySources::least_length(const SurfacePoint& target, const PointFan& fan, double upper, const JobStage& stage,
                                   Index* point) const {
  if (fan.is_vertex) return upper;
  std::vector<Index> near;
  for (const PointFan::Arc& arc : fan.arcs) {
    auto entry = std::ranges::lower_bound(entries_, Entry{arc.vertex, 0});
    for (; entry != entries_.end() && entry->vertex == arc.vertex; ++entry) near.push_back(entry->source);
  }
  std::ranges::sort(near);
  const auto repeated = std::ranges::unique(near);
  near.erase(repeated.begin(), repeated.end());
  // Nearest first as the bird flies: when that is farther than the way known, so are all that follow.
  const Vec3 place = position(graph_.mesh(), target);
  std::vector<std::pair<double, Index>> in_order;
  for (const Index s : near) in_order.emplace_back((positions_[s] - place).norm() * k_bird, s);
  std::ranges::sort(in_order);
  for (const auto& [bird, s] : in_order) {
    if (bird >= upper) break;
    stage.check();
    const double length = direct_length(graph_, points_[s], fans_[s], target, fan);
    if (length >= upper) continue;
    upper = length;
    if (point) *point = s;
  }
  return upper;
}

std::vector<double> distances_at(const SaddleVertexGraph& graph, const SurfacePoints& points,
                                 std::span<const PointFan> fans, const std::function<double(Index)>& at_vertex,
                                 const SurfacePoints& targets, std::vector<double> known, const JobStage& stage) {
  const NearbySources nearby(graph, points, fans);
  const auto reach = [&](Index i, const PointFan& fan) {
    for (const PointFan::Arc& arc : fan.arcs) known[i] = std::min(known[i], at_vertex(arc.vertex) + arc.length);
    known[i] = nearby.least_length(targets[i], fan, known[i], stage);
  };
  for (Index i = 0; i < static_cast<Index>(targets.size()); ++i)
    if (vertex_at(graph.mesh(), targets[i]) != k_none) reach(i, point_fan(graph, targets[i], {}));
  // Looked at as soon as its fan is there: how the two share the time differs from mesh to mesh.
  for_each_fan(graph, targets, {}, FanAngles::none, 0, stage,
               [&](Index i, std::span<const DirectArc> arcs) { reach(i, point_fan(graph, targets[i], arcs)); });
  return known;
}

}  // namespace saddleback
