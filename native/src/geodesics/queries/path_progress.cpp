#include "geodesics/queries/path_progress.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "geodesics/queries/source_arcs.h"
#include "geodesics/unfolding/needles.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

// Edges between a point and the nearest of many sources, over the root of the vertices that a source has: as in a disk.
// From a single one it is farther, as far as the surface is long.
constexpr double k_in_disk = 0.35, k_from_one = 0.9;

// A point inside a face is looked at from the sources near it, if these are nearer than so many edges.
constexpr double k_look = 90, k_in_sight = 20;

double likely_edges(const Mesh& mesh, const SurfacePoints& sources) {
  const auto count = static_cast<double>(sources.size());
  return std::lerp(k_in_disk, k_from_one, 1 / std::sqrt(count)) * std::sqrt(mesh.vertex_count() / count);
}

}  // namespace

PathProgress::PathProgress(const SaddleVertexGraph& graph, const Work& work, const JobStage& stage)
    : graph_(graph),
      work_(work),
      stage_(stage),
      threads_(thread_count(work.options.threads)),
      of_look_(needle_factor(graph.mesh()) * k_look) {
  const double of_source_fans = cost_of_fans(graph, work.sources);
  const double of_field = cost_of_field(graph, of_source_fans);
  const double of_fans = cost_of_fans(graph, work.targets, FirstFans::later);
  const double of_fan_mesh = of_source_fans > 0 ? 0 : cost_of_fans(graph, work.targets) - of_fans;
  const double edges = likely_edges(graph.mesh(), work.sources);
  const auto count = static_cast<double>(work.targets.size());
  const auto inside = static_cast<double>(std::ranges::count_if(
      work.targets, [&](const SurfacePoint& target) { return vertex_at(graph.mesh(), target) == k_none; }));
  of_fan_ = of_fans / std::max(1.0, inside);
  before_ = of_field + of_fan_mesh;
  const double all = before_ + (inside * cost_inside(edges) + count * cost_of_path(edges)) / threads_;
  with_field_ = of_field / all;
  prepared_ = before_ / all;
}

double PathProgress::cost_of_field(const SaddleVertexGraph& graph, double of_fans) {
  constexpr double k_seeds = 0.3;  // each arc of the fans is one
  return (k_with_angles + k_seeds) * of_fans + graph.mesh().vertex_count();
}

/// The first arcs take a search among many, the edges that are crossed farther on little; shortened each is laid out
/// again, the more often the longer the path is.
double PathProgress::cost_of_path(double edges) const {
  constexpr double k_end = 2, k_near = 5, k_near_edge = 2.5, k_edge = 1, k_shortened = 2.4, k_longer = 1.25;
  return k_end + k_near_edge * std::min(edges, k_near) + k_edge * edges +
         (work_.options.shorten ? k_shortened * std::pow(edges, k_longer) : 0);
}

/// What a target inside a face takes beside.
double PathProgress::cost_inside(double edges) const { return of_fan_ + (edges < k_in_sight ? of_look_ : 0); }

void PathProgress::begin_paths(const LabelField& field) {
  const Mesh& mesh = graph_.mesh();
  costs_.reserve(work_.targets.size());
  for (const SurfacePoint& target : work_.targets) {
    double distance = std::numeric_limits<double>::infinity();
    for (const Index corner : mesh.triangles()[target.face]) distance = std::min(distance, field.distance[corner]);
    const double edges = std::isfinite(distance) ? distance / mesh.mean_edge_length() : 0;
    costs_.push_back(cost_of_path(edges) + (vertex_at(mesh, target) == k_none ? cost_inside(edges) : 0));
  }
  all_ = std::max(1.0, std::accumulate(costs_.begin(), costs_.end(), 0.0));
  prepared_at_ = clock_.seconds();
}

void PathProgress::found(double share, int thread) {
  const double done = done_.fetch_add(share, std::memory_order_relaxed) + share;
  stage_.check();
  if (thread != 0 || !stage_.is_watched()) return;
  // What was expected counts as much as this share of the paths.
  constexpr double k_belief = 0.03;
  const double so_far = clock_.seconds(), expected = prepared_at_ / before_ * all_ / threads_;
  const double following = (so_far - prepared_at_ + k_belief * expected) / (done + k_belief);
  stage_.update(so_far / (so_far + following * std::max(0.0, 1 - done)));
}

}  // namespace saddleback
