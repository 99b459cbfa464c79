#include "geodesics/point_targets.h"

#include <algorithm>
#include <limits>

#include "geodesics/line_of_sight.h"

namespace saddleback {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
// Room for rounding: no geodesic is shorter than the straight line.
constexpr double k_bird = 1 - 1e-12;

bool share_a_vertex(const PointFan& a, const PointFan& b) {
  auto i = a.arcs.begin();
  auto j = b.arcs.begin();
  while (i != a.arcs.end() && j != b.arcs.end()) {
    if (i->vertex == j->vertex) return true;
    ++(i->vertex < j->vertex ? i : j);
  }
  return false;
}

}  // namespace

double direct_length(const SaddleVertexGraph& graph, const SurfacePoint& a, const PointFan& a_fan,
                     const SurfacePoint& b, const PointFan& b_fan) {
  if (a_fan.is_vertex || b_fan.is_vertex || !share_a_vertex(a_fan, b_fan)) return k_infinity;
  thread_local LineOfSight sight;
  const double reach = a_fan.reach + b_fan.reach, length = sight.length(graph.unfolding(), a, b, reach);
  return length < reach ? length : k_infinity;
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

}  // namespace saddleback
