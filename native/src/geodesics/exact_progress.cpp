#include "geodesics/exact_progress.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace saddleback {
namespace {

// Straight lines are this much shorter than paths along the edges of common meshes.
constexpr double k_straighter = 0.92;
// Windows a vertex grow with its distance from the source: in proportion on flat meshes, hardly where saddles abound.
constexpr double k_growth = 0.35;

/// In buckets of an edge's length, each worked off in any order: nearly shortest, which is as good here.
std::vector<double> lengths_along_edges(const ExactSurface& surface, const SurfacePoints& sources,
                                        const JobStage& stage) {
  const Mesh& mesh = surface.mesh();
  constexpr std::size_t k_most_buckets = 1 << 16;  // a longer way goes into the last one
  const double per_bucket = 1 / mesh.mean_edge_length();
  std::vector<double> distances(mesh.vertex_count(), std::numeric_limits<double>::infinity());
  std::vector<std::vector<Index>> buckets(1);
  const auto offer = [&](Index vertex, double distance) {
    if (distance >= distances[vertex]) return;
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
    stage.check();
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

ExactProgress::ExactProgress(const ExactSurface& surface, const SurfacePoints& sources, double limit,
                             const JobStage& stage)
    : stage_(stage) {
  if (!stage.is_watched()) return;
  for (const double length : lengths_along_edges(surface, sources, stage))
    if (k_straighter * length <= limit && std::isfinite(length)) distances_.push_back(k_straighter * length);
  std::sort(distances_.begin(), distances_.end());
  work_.reserve(distances_.size());
  double sum = 0;
  for (const double distance : distances_) work_.push_back(sum += std::pow(distance, k_growth));
}

void ExactProgress::reached(double distance) {
  if (!stage_.is_watched()) return;
  while (next_ < distances_.size() && distances_[next_] <= distance) ++next_;
  if (next_ > 0 && work_.back() > 0) stage_.update(work_[next_ - 1] / work_.back());
  stage_.check();
}

}  // namespace saddleback
