#include "geodesics/unfolding/edge_ways.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace saddleback {

/// In buckets of an edge's length, each worked off as it was filled: nearly shortest, which is as good here. Where
/// edges are much shorter than most a bucket holds many of them, and the latest first would measure each over and over.
std::vector<double> ways_along_edges(const Mesh& mesh, const SurfacePoints& sources, double limit,
                                     const JobStage& stage) {
  constexpr std::size_t k_most_buckets = 1 << 16;  // a longer way goes into the last one
  const double per_bucket = 1 / mesh.mean_edge_length();
  std::vector<double> distances(mesh.vertex_count(), std::numeric_limits<double>::infinity());
  struct Reached {
    Index vertex;
    double distance;
  };
  std::vector<std::vector<Reached>> buckets(1);
  double reached = 0;
  const auto offer = [&](Index vertex, double distance) {
    if (distance >= distances[vertex] || distance > limit) return;
    if (std::isinf(distances[vertex])) ++reached;
    distances[vertex] = distance;
    const double bucket = std::min(distance * per_bucket, static_cast<double>(k_most_buckets - 1));
    buckets.resize(std::max(buckets.size(), static_cast<std::size_t>(bucket) + 1));
    buckets[static_cast<std::size_t>(bucket)].push_back({vertex, distance});
  };
  for (const SurfacePoint& source : sources) {
    const Vec3 place = position(mesh, source);
    for (const Index vertex : mesh.triangles()[source.face]) offer(vertex, (mesh.position(vertex) - place).norm());
  }
  for (std::size_t bucket = 0; bucket < buckets.size(); ++bucket) {
    stage.update(reached / mesh.vertex_count());
    for (std::size_t i = 0; i < buckets[bucket].size(); ++i) {
      const auto [vertex, distance] = buckets[bucket][i];
      if (distances[vertex] < distance) continue;
      for_neighbors(mesh, vertex, [&](Index other, Index h) { offer(other, distance + mesh.length(h)); });
    }
    buckets[bucket] = {};
  }
  return distances;
}

}  // namespace saddleback
