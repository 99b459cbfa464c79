#include "geodesics/distance_progress.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace saddleback {
namespace {

// Straight lines are this much shorter than paths along the edges of common meshes.
constexpr double k_straighter = 0.92;
constexpr double k_most_rings = 1 << 16;  ///< farther vertices go into the last one

/// In buckets of an edge's length, each worked off in any order: nearly shortest, which is as good here.
/// \return infinity for vertices beyond the limit.
std::vector<double> lengths_along_edges(const Mesh& mesh, const SurfacePoints& sources, double limit,
                                        const JobStage& stage) {
  constexpr std::size_t k_most_buckets = 1 << 16;  // a longer way goes into the last one
  const double per_bucket = 1 / mesh.mean_edge_length();
  std::vector<double> distances(mesh.vertex_count(), std::numeric_limits<double>::infinity());
  std::vector<std::vector<Index>> buckets(1);
  double reached = 0;
  const auto offer = [&](Index vertex, double distance) {
    if (distance >= distances[vertex] || distance > limit) return;
    if (std::isinf(distances[vertex])) ++reached;
    distances[vertex] = distance;
    const double bucket = std::min(distance * per_bucket, static_cast<double>(k_most_buckets - 1));
    buckets.resize(std::max(buckets.size(), static_cast<std::size_t>(bucket) + 1));
    buckets[static_cast<std::size_t>(bucket)].push_back(vertex);
  };
  for (const SurfacePoint& source : sources) {
    const Vec3 place = position(mesh, source);
    for (const Index vertex : mesh.triangles()[source.face]) offer(vertex, (mesh.position(vertex) - place).norm());
  }
  for (std::size_t bucket = 0; bucket < buckets.size(); ++bucket) {
    stage.update(reached / mesh.vertex_count());
    while (!buckets[bucket].empty()) {
      const Index vertex = buckets[bucket].back();
      buckets[bucket].pop_back();
      if (static_cast<std::size_t>(distances[vertex] * per_bucket) < bucket && bucket + 1 < k_most_buckets) continue;
      const Index first = mesh.first_halfedge(vertex);
      Index h = first;
      do {
        offer(mesh.to(h), distances[vertex] + mesh.length(h));
        const Index last = Mesh::prev(h);
        if (mesh.twin(last) == k_none) offer(mesh.from(last), distances[vertex] + mesh.length(last));
        h = mesh.rotate(h);
      } while (h != k_none && h != first);
    }
  }
  return distances;
}

}  // namespace

DistanceProgress::DistanceProgress(const Mesh& mesh, const SurfacePoints& sources, const Extent& extent,
                                   const JobStage& guessing, const JobStage& running)
    : stage_(running), per_edge_(1 / mesh.mean_edge_length()) {
  if (!stage_.is_watched()) return;
  for (const double length : lengths_along_edges(mesh, sources, extent.limit / k_straighter, guessing)) {
    if (std::isinf(length)) continue;
    const double edges = k_straighter * length * per_edge_;
    const auto ring = static_cast<std::size_t>(std::min(edges, k_most_rings));
    if (ring >= work_.size()) work_.resize(ring + 1, 0);
    work_[ring] += std::pow(edges, extent.growth);
  }
  std::partial_sum(work_.begin(), work_.end(), work_.begin());
}

void DistanceProgress::reached(double distance) {
  if (work_.empty()) return;
  const double edges = distance * per_edge_, ring = std::floor(edges);
  double done = work_.back();
  if (ring < static_cast<double>(work_.size())) {
    const auto i = static_cast<std::size_t>(ring);
    const double before = i > 0 ? work_[i - 1] : 0;
    done = before + (edges - ring) * (work_[i] - before);
  }
  stage_.update(work_.back() > 0 ? done / work_.back() : 0);
}

}  // namespace saddleback
