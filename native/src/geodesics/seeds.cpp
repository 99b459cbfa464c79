#include "geodesics/seeds.h"

#include <memory>

#include "saddleback/error.h"

#include "geodesics/window_propagation.h"
#include "support/parallel.h"

namespace saddleback {

std::vector<Seed> make_seeds(const SaddleVertexGraph& graph, const SurfacePoints& sources, const JobStage& stage) {
  if (sources.empty()) throw InputError("sources: wanted at least one source, got none");
  check_surface_points(graph.mesh(), sources, "sources");
  const auto count = static_cast<Index>(sources.size());
  std::vector<Seed> seeds;
  std::vector<Index> inside;  // of faces and edges
  for (Index i = 0; i < count; ++i) {
    if (const Index vertex = vertex_at(graph.mesh(), sources[i]); vertex != k_none) {
      seeds.push_back({vertex, i, 0});
    } else {
      inside.push_back(i);
    }
  }
  if (inside.empty()) return seeds;
  std::vector<std::vector<DirectArc>> fans(inside.size());
  std::vector<std::unique_ptr<WindowPropagator>> propagators(thread_count(0));
  parallel_for(static_cast<Index>(inside.size()), 0, 16, [&](Index i, int thread) {
    stage.check();
    if (!propagators[thread]) propagators[thread] = std::make_unique<WindowPropagator>(graph.unfolding());
    graph.fan(sources[inside[i]], *propagators[thread], fans[i]);
  });
  for (std::size_t i = 0; i < inside.size(); ++i) {
    for (const DirectArc& arc : fans[i])
      seeds.push_back({arc.vertex, inside[i], graph.arcs().codec().round(arc.length)});
  }
  return seeds;
}

}  // namespace saddleback
