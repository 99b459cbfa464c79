#include "geodesics/queries/landmarks.h"

#include <algorithm>
#include <limits>

namespace saddleback {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();

/// Returns for each component its vertex with the largest value.
std::vector<Seed> largest_in_components(const Mesh& mesh, std::span<const double> values) {
  std::vector<Index> chosen(mesh.component_count(), k_none);
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    Index& best = chosen[mesh.component_of(v)];
    if (best == k_none || values[v] > values[best]) best = v;
  }
  std::vector<Seed> seeds;
  for (const Index vertex : chosen) seeds.push_back({vertex, 0, 0});
  return seeds;
}

}  // namespace

Landmarks::Landmarks(const SaddleVertexGraph& graph, GraphSearch& search, const JobStage& stage)
    : graph_(&graph), unit_(graph.mesh().mean_edge_length()) {
  const auto count = static_cast<std::size_t>(graph.mesh().vertex_count());
  table_.resize(count * k_count);
  std::vector<double> distance(count), nearest(count, 0);
  double longest = 0;
  // Pass -1 only finds the rim: the first landmark is as far as can be from each component's first vertex.
  for (int pass = -1; pass < k_count; ++pass) {
    const JobStage part = stage.part((pass + 1.0) / (k_count + 1), (pass + 2.0) / (k_count + 1));
    search.run(graph, largest_in_components(graph.mesh(), nearest), {}, SearchLabels::none, part);
    search.write_distances(graph, distance);
    if (pass <= 0) std::fill(nearest.begin(), nearest.end(), k_infinity);
    for (std::size_t v = 0; v < count; ++v) nearest[v] = std::min(nearest[v], distance[v]);
    if (pass < 0) continue;
    for (std::size_t v = 0; v < count; ++v) {
      const double units = distance[v] / unit_;
      longest = std::max(longest, units);
      table_[static_cast<std::size_t>(graph.node_of(static_cast<Index>(v))) * k_count +
             static_cast<std::size_t>(pass)] = static_cast<float>(units);
    }
  }
  // Two rounded distances and their rounded difference, half a unit in the last place each, and as much again. Targets
  // lie an arc beyond a vertex.
  slack_ = static_cast<float>(4 * (longest + graph.arcs().longest() / unit_)) * std::numeric_limits<float>::epsilon();
}

Landmarks::Target Landmarks::target(const PointFan& fan, const Vec3& position) const {
  Target result;
  result.position = position;
  for (std::size_t i = 0; i < k_count; ++i) {
    double least = k_infinity, most = -k_infinity;
    for (const PointFan::Arc& arc : fan.arcs) {
      const double known = table_[static_cast<std::size_t>(graph_->node_of(arc.vertex)) * k_count + i];
      least = std::min(least, known + arc.length / unit_);
      most = std::max(most, known - arc.length / unit_);
    }
    result.least[i] = static_cast<float>(least);
    result.most[i] = static_cast<float>(most);
  }
  return result;
}

}  // namespace saddleback
