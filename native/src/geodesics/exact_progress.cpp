#include "geodesics/exact_progress.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>

namespace saddleback {
namespace {

// Straight lines are this much shorter than paths along the edges of common meshes.
constexpr double k_straighter = 0.92;
// Windows a vertex grow with its distance from the source: in proportion on flat meshes, hardly where saddles abound.
constexpr double k_growth = 0.35;

std::vector<double> lengths_along_edges(const ExactSurface& surface, const SurfacePoints& sources,
                                        const JobStage& stage) {
  using Entry = std::pair<double, Index>;
  const Mesh& mesh = surface.mesh();
  std::vector<double> distances(mesh.vertex_count(), std::numeric_limits<double>::infinity());
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto offer = [&](Index vertex, double distance) {
    if (distance >= distances[vertex]) return;
    distances[vertex] = distance;
    queue.emplace(distance, vertex);
  };
  for (const SurfacePoint& source : sources) {
    const Vec3 place = position(mesh, source);
    for (const Index vertex : mesh.triangles()[source.face]) offer(vertex, (mesh.position(vertex) - place).norm());
  }
  while (!queue.empty()) {
    const auto [distance, vertex] = queue.top();
    queue.pop();
    if (distance > distances[vertex]) continue;
    stage.check();
    const Index first = mesh.first_halfedge(vertex);
    Index h = first;
    do {
      offer(mesh.to(h), distance + mesh.length(h));
      const Index last = Mesh::prev(h);
      if (mesh.twin(last) == k_none) offer(mesh.from(last), distance + mesh.length(last));
      h = mesh.rotate(h);
    } while (h != k_none && h != first);
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
