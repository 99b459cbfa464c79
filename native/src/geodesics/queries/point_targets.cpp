#include "geodesics/queries/point_targets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "geodesics/unfolding/line_of_sight.h"

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

bool is_in_needle(const Mesh& mesh, const SurfacePoint& point) {
  const Index h = 3 * point.face;
  return is_needle(mesh.length(h), mesh.length(h + 1), mesh.length(h + 2));
}

/// Length of the straight line between two points, if it is less than `most`, else infinity; by bounds that grow. The
/// tighter the bound, the fewer windows: else wide fans would end the search before it has seen the point.
double straight_length(const SaddleVertexGraph& graph, const SurfacePoint& a, const SurfacePoint& b, double bird,
                       double most, double upper) {
  constexpr double k_growth = 4, k_least = 1e-6;
  LineOfSight sight(graph.is_exact());
  for (double bound = std::max(bird * k_growth, most * k_least);; bound *= k_growth) {
    bound = std::min(bound, most);
    const double length = sight.length(graph.unfolding(), a, b, bound);
    if (length < bound) return length;
    if (bound >= std::min(most, upper)) return k_infinity;
  }
}

}  // namespace

double direct_length(const SaddleVertexGraph& graph, const SurfacePoint& a, const PointFan& a_fan,
                     const SurfacePoint& b, const PointFan& b_fan, double upper) {
  if (a_fan.is_vertex || b_fan.is_vertex) return k_infinity;
  const double bird = graph.mesh().bird((position(graph.mesh(), a) - position(graph.mesh(), b)).norm());
  const double around = over_a_vertex(a_fan, b_fan);
  if (around < k_infinity) return straight_length(graph, a, b, bird, around, upper);
  // Points of needles are near each other, and far from all that they see of vertices.
  const double reach = a_fan.reach + b_fan.reach;
  if (bird > reach || !(is_in_needle(graph.mesh(), a) || is_in_needle(graph.mesh(), b))) return k_infinity;
  return straight_length(graph, a, b, bird, reach, upper);
}

NearbySources::NearbySources(const SaddleVertexGraph& graph, const SurfacePoints& points,
                             std::span<const PointFan> fans)
    : graph_(graph), points_(points), fans_(fans) {
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < points.size(); ++i) {
    positions_.push_back(position(graph.mesh(), points[i]));
    if (fans[i].is_vertex) continue;  // seen by arcs of the target's fan
    box.extend(positions_.back());
    reach_ = std::max(reach_, fans[i].reach);
    entries_.push_back({0, static_cast<Index>(i)});
  }
  if (!entries_.empty()) box.sizes().maxCoeff(&axis_);
  for (Entry& entry : entries_) entry.along = positions_[entry.source][axis_];
  std::ranges::sort(entries_);
}

double NearbySources::least_length(const SurfacePoint& target, const PointFan& fan, double upper, const JobStage& stage,
                                   Index* point) const {
  if (fan.is_vertex) return upper;
  const Vec3 place = position(graph_.mesh(), target);
  const double farthest = std::min(upper, fan.reach + reach_) / k_bird, around = graph_.mesh().in_space(farthest);
  // Nearest first as the bird flies: when that is farther than the way known, so are all that follow.
  std::vector<std::pair<double, Index>> in_order;
  auto entry = std::ranges::lower_bound(entries_, place[axis_] - around, {}, &Entry::along);
  for (; entry != entries_.end() && entry->along <= place[axis_] + around; ++entry) {
    const double bird = graph_.mesh().bird((positions_[entry->source] - place).norm()) * k_bird;
    if (bird <= farthest) in_order.emplace_back(bird, entry->source);
  }
  std::ranges::sort(in_order);
  for (const auto& [bird, s] : in_order) {
    if (bird >= upper) break;
    stage.check();
    const double length = direct_length(graph_, points_[s], fans_[s], target, fan, upper);
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
