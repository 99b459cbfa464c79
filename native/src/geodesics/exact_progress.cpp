#include "geodesics/exact_progress.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace saddleback {
namespace {

// Windows a vertex grow with its distance from the source: in proportion on flat meshes, hardly where saddles abound.
constexpr double k_growth = 0.35;
// Microseconds a vertex on one machine, of which only ratios matter: a surface's layout, the guess, and windows, which
// grow by that power of the vertices that a source has.
constexpr double k_cost_of_surface = 0.7, k_cost_of_guess = 0.35, k_cost_of_windows = 0.8, k_growth_of_windows = 0.15;

/// Vertices within the limit, all of them when there is none.
double vertices_within(const Mesh& mesh, double source_count, double limit) {
  const double disks = source_count * std::numbers::pi * limit * limit;
  return mesh.vertex_count() * std::min(1.0, disks / mesh.area());
}

double cost_of_windows(const Mesh& mesh, double source_count, double limit) {
  const double count = vertices_within(mesh, source_count, limit);
  return k_cost_of_windows * count * std::pow(std::max(1.0, count / source_count), k_growth_of_windows);
}

double cost_of_guess(const Mesh& mesh, double source_count, double limit) {
  return k_cost_of_guess * vertices_within(mesh, source_count, limit);
}

}  // namespace

double share_of_surface(const Mesh& mesh, std::size_t source_count, double limit) {
  const auto sources = static_cast<double>(source_count);
  const double surface = k_cost_of_surface * mesh.vertex_count();
  return surface / (surface + cost_of_guess(mesh, sources, limit) + cost_of_windows(mesh, sources, limit));
}

DistanceProgress exact_progress(const Mesh& mesh, const SurfacePoints& sources, double limit, const JobStage& stage) {
  const auto source_count = static_cast<double>(sources.size());
  const double guess = cost_of_guess(mesh, source_count, limit);
  const double share = guess / (guess + cost_of_windows(mesh, source_count, limit));
  return {mesh, sources, {.limit = limit, .growth = k_growth}, stage.part(0, share), stage.part(share, 1)};
}

}  // namespace saddleback
