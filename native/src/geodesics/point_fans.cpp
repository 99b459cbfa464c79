#include "geodesics/point_fans.h"

#include <algorithm>

#include "geodesics/query_cache.h"
#include "support/parallel.h"

namespace saddleback {

PointFan FanFinder::find(const SaddleVertexGraph& graph, const SurfacePoint& point) {
  if (const Index vertex = vertex_at(graph.mesh(), point); vertex != k_none) return {{{vertex, 0}}, 0, true};
  if (!propagator_) propagator_ = std::make_unique<WindowPropagator>(graph.unfolding());
  graph.fan(point, *propagator_, arcs_);
  PointFan fan;
  fan.arcs.reserve(arcs_.size());
  for (const DirectArc& arc : arcs_) {
    fan.arcs.push_back({arc.vertex, graph.arcs().codec().round(arc.length)});
    fan.reach = std::max(fan.reach, arc.length);
  }
  std::sort(fan.arcs.begin(), fan.arcs.end(),
            [](const PointFan::Arc& a, const PointFan::Arc& b) { return a.vertex < b.vertex; });
  return fan;
}

std::vector<PointFan> find_fans(const SaddleVertexGraph& graph, const SurfacePoints& points, const JobStage& stage) {
  const auto count = static_cast<Index>(points.size());
  std::vector<PointFan> fans(count);
  std::vector<Index> inside;  // of faces and edges: the others cost nothing
  FanFinder of_vertices;
  for (Index i = 0; i < count; ++i) {
    if (vertex_at(graph.mesh(), points[i]) == k_none) {
      inside.push_back(i);
    } else {
      fans[i] = of_vertices.find(graph, points[i]);
    }
  }
  if (inside.empty()) return fans;
  std::vector<ScratchPool<FanFinder>::Lease> finders;
  for (int thread = 0; thread < thread_count(0); ++thread) finders.push_back(graph.query_cache().fan_finders.lease());
  parallel_for(static_cast<Index>(inside.size()), 0, 8, [&](Index i, int thread) {
    stage.check();
    fans[inside[i]] = finders[thread]->find(graph, points[inside[i]]);
  });
  return fans;
}

std::vector<Seed> seeds_of(std::span<const PointFan> fans) {
  std::vector<Seed> seeds;
  seeds.reserve(fans.size());
  for (std::size_t i = 0; i < fans.size(); ++i) {
    for (const PointFan::Arc& arc : fans[i].arcs) seeds.push_back({arc.vertex, static_cast<Index>(i), arc.length});
  }
  return seeds;
}

}  // namespace saddleback
