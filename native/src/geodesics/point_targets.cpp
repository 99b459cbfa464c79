#include "geodesics/point_targets.h"

#include <algorithm>
#include <limits>

#include "geodesics/line_of_sight.h"

namespace saddleback {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();

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

NearbySources::NearbySources(std::span<const PointFan> sources) {
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (sources[i].is_vertex) continue;  // seen by arcs of the target's fan
    for (const PointFan::Arc& arc : sources[i].arcs) entries_.push_back({arc.vertex, static_cast<Index>(i)});
  }
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
    return a.vertex != b.vertex ? a.vertex < b.vertex : a.source < b.source;
  });
}

void NearbySources::find(const PointFan& target, std::vector<Index>& sources) const {
  sources.clear();
  if (target.is_vertex) return;
  for (const PointFan::Arc& arc : target.arcs) {
    auto entry = std::lower_bound(entries_.begin(), entries_.end(), arc.vertex,
                                  [](const Entry& known, Index vertex) { return known.vertex < vertex; });
    for (; entry != entries_.end() && entry->vertex == arc.vertex; ++entry) sources.push_back(entry->source);
  }
  std::sort(sources.begin(), sources.end());
  sources.erase(std::unique(sources.begin(), sources.end()), sources.end());
}

}  // namespace saddleback
