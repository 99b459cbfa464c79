#include "geodesics/exact/distance_progress.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "geodesics/unfolding/angle_defect.h"
#include "geodesics/unfolding/edge_ways.h"

namespace saddleback {
namespace {

constexpr double k_most_rings = 1 << 16;            ///< farther vertices go into the last one
constexpr double k_laid = 0.03, k_guessing = 0.05;  ///< of the time, usually: what comes before, and this
constexpr double k_vertex = 8;                      ///< windows that take as long as a vertex itself
// How much farther than the limit ways are followed: they may be longer than it seems.
constexpr double k_farther = 1.15;

/// Edges in which windows are bent until they end, on the whole.
double life_of_windows(const Mesh& mesh) {
  constexpr double k_least = 1, k_life = 10, k_at = 60, k_power = 3;
  return k_least + k_life * std::pow(edges_until_bent(mesh) / k_at, k_power);
}

/// The mean of each and those near it; beyond the ends all is as there.
std::vector<double> smoothed(const std::vector<double>& values) {
  constexpr std::ptrdiff_t k_near = 5;
  const std::ptrdiff_t last = std::ssize(values) - 1;
  std::vector<double> result(values.size());
  for (std::ptrdiff_t i = 0; i <= last; ++i) {
    double sum = 0;
    for (std::ptrdiff_t near = i - k_near; near <= i + k_near; ++near)
      sum += values[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(near, 0, last))];
    result[static_cast<std::size_t>(i)] = sum / (2 * k_near + 1);
  }
  return result;
}

/// Of each ring, from its vertices and their curvature (2 pi less the angle about them).
std::vector<double> work_of_rings(const std::vector<double>& vertices, const std::vector<double>& curvature,
                                  double life) {
  constexpr double k_edges_a_vertex = 0.87;  // of the front, where triangles are even
  const std::vector<double> front = smoothed(vertices), bent = smoothed(curvature);
  std::vector<double> work(vertices.size());
  double windows = 0, inside = 0;
  for (std::size_t ring = 0; ring < vertices.size(); ++ring) {
    windows = (windows + vertices[ring]) * (1 - 1 / life);
    inside += bent[ring];
    if (ring > 0 && front[ring - 1] > 0) {
      const double shorter = 1 - front[ring] / front[ring - 1];
      // By Gauss and Bonnet: a free front loses what it holds of curvature beyond a disk's, a step.
      const double drawn_together =
          std::max(0.0, inside - 2 * std::numbers::pi) / std::max(1.0, k_edges_a_vertex * front[ring]);
      windows *= 1 - std::clamp(shorter - drawn_together, 0.0, 1.0);
    }
    work[ring] = k_vertex * vertices[ring] + windows;
  }
  return work;
}

/// Sums up to and without each.
std::vector<double> sums(const std::vector<double>& values) {
  std::vector<double> result(values.size() + 1, 0.0);
  std::partial_sum(values.begin(), values.end(), result.begin() + 1);
  return result;
}

}  // namespace

DistanceProgress::DistanceProgress(const Mesh& mesh, const SurfacePoints& sources, double limit, const WorkClock& clock,
                                   const JobStage& stage)
    : stage_(stage), per_edge_(1 / mesh.mean_edge_length()), limit_(limit), clock_(clock) {
  if (!stage_.is_watched()) return;
  const double before = clock_.seconds();
  std::vector<double> vertices, curvature;
  const std::vector<double> ways =
      ways_along_edges(mesh, sources, k_farther * limit / k_straighter, stage.part(k_laid, k_laid + k_guessing));
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (std::isinf(ways[v])) continue;
    const auto ring = static_cast<std::size_t>(std::min(k_straighter * ways[v] * per_edge_, k_most_rings));
    if (ring >= vertices.size()) {
      vertices.resize(ring + 1, 0.0);
      curvature.resize(ring + 1, 0.0);
    }
    ++vertices[ring];
    if (!mesh.is_boundary(v)) curvature[ring] += 2 * std::numbers::pi - mesh.total_angle(v);
  }
  work_ = sums(work_of_rings(vertices, curvature, life_of_windows(mesh)));
  vertices_ = sums(vertices);
  guessing_ = clock_.seconds() - before;
}

double DistanceProgress::work_before(double ring) const {
  const double whole = std::clamp(std::floor(ring), 0.0, static_cast<double>(work_.size() - 1));
  const auto i = static_cast<std::size_t>(whole);
  return i + 1 < work_.size() ? std::lerp(work_[i], work_[i + 1], ring - whole) : work_.back();
}

void DistanceProgress::reached(double distance, Index vertices) {
  if (work_.back() <= 0) return;
  // How far that is as ways along edges tell it shows how much too long or too short they are on this mesh.
  constexpr double k_too_short = 0.8, k_too_long = 1.25;
  while (ring_ + 2 < vertices_.size() && vertices_[ring_ + 1] <= vertices) ++ring_;
  const double more = vertices_[ring_ + 1] - vertices_[ring_],
               within = more > 0 ? std::clamp((vertices - vertices_[ring_]) / more, 0.0, 1.0) : 0.0,
               ring = static_cast<double>(ring_) + within;
  double all = work_.back();
  if (!std::isinf(limit_))
    all = work_before(limit_ * per_edge_ *
                      (distance > 0 ? std::clamp(ring / (distance * per_edge_), k_too_short, k_too_long) : 1.0));
  const double share = all > 0 ? std::min(1.0, work_before(ring) / all) : 1, so_far = clock_.seconds();
  // What was expected counts as much as this share of the work.
  constexpr double k_belief = 0.03;
  if (began_ < 0) began_ = so_far;
  const double running = (so_far - began_ + k_belief * guessing_ / k_guessing) / (share + k_belief);
  stage_.update(so_far / (so_far + running * (1 - share)));
}

}  // namespace saddleback
