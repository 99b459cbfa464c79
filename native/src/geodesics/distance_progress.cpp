#include "geodesics/distance_progress.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "geodesics/edge_ways.h"

namespace saddleback {
namespace {

constexpr double k_most_rings = 1 << 16;  ///< farther vertices go into the last one
constexpr double k_guessing = 0.06;       ///< of the time, usually
constexpr double k_vertex = 8;            ///< windows that take as long as a vertex itself

}  // namespace

DistanceProgress::DistanceProgress(const Mesh& mesh, const SurfacePoints& sources, const Extent& extent,
                                   const JobStage& stage)
    : stage_(stage), per_edge_(1 / mesh.mean_edge_length()) {
  if (!stage_.is_watched()) return;
  for (const double length : ways_along_edges(mesh, sources, extent.limit / k_straighter, stage.part(0, k_guessing))) {
    if (std::isinf(length)) continue;
    const double edges = k_straighter * length * per_edge_;
    const auto ring = static_cast<std::size_t>(std::min(edges, k_most_rings));
    if (ring >= work_.size()) work_.resize(ring + 1, 0);
    work_[ring] += k_vertex + edges / std::hypot(1, edges / extent.until_bent);
  }
  std::partial_sum(work_.begin(), work_.end(), work_.begin());
  guessed_ = clock_.seconds();
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
  // What was expected counts as much as this share of the work.
  constexpr double k_belief = 0.03;
  const double share = work_.back() > 0 ? done / work_.back() : 0, so_far = clock_.seconds();
  const double running = (so_far - guessed_ + k_belief * guessed_ / k_guessing) / (share + k_belief);
  stage_.update(so_far / (so_far + running * (1 - share)));
}

}  // namespace saddleback
