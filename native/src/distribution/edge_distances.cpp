#include "distribution/edge_distances.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "mesh/tables/outgoing.h"

namespace saddleback::distribution {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();

/// Finds of every component the vertex of the largest finite value.
std::vector<Index> farthest(const Mesh& mesh, const std::vector<double>& distances) {
  std::vector<Index> result(static_cast<std::size_t>(mesh.component_count()), k_none);
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    Index& best = result[mesh.component_of(v)];
    if (best == k_none || distances[v] > distances[best]) best = v;
  }
  return result;
}

}  // namespace

std::vector<double> edge_distances(const Mesh& mesh, std::span<const Index> sources, double limit) {
  std::vector<double> distances(static_cast<std::size_t>(mesh.vertex_count()), k_infinity);
  using Entry = std::pair<double, Index>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto reach = [&](Index vertex, double distance) {
    if (!(distance < distances[vertex]) || distance > limit) return;
    distances[vertex] = distance;
    queue.push({distance, vertex});
  };
  for (const Index source : sources) reach(source, 0);
  while (!queue.empty()) {
    const auto [distance, vertex] = queue.top();
    queue.pop();
    if (distance != distances[vertex]) continue;
    for (const Index h : outgoing(mesh, vertex)) {
      reach(mesh.to(h), distance + mesh.length(h));
      reach(mesh.apex(h), distance + mesh.length(Mesh::prev(h)));
    }
  }
  return distances;
}

std::vector<double> sweep_coordinate(const Mesh& mesh) {
  std::vector<double> zeros(static_cast<std::size_t>(mesh.vertex_count()), 0.0);
  const std::vector<Index> anywhere = farthest(mesh, zeros);
  const std::vector<Index> ends = farthest(mesh, edge_distances(mesh, anywhere, k_infinity));
  std::vector<double> front = edge_distances(mesh, ends, k_infinity);
  const double most = *std::max_element(front.begin(), front.end());
  for (double& value : front) value /= most;
  return front;
}

}  // namespace saddleback::distribution
