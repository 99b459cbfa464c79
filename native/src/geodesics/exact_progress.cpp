#include "geodesics/exact_progress.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace saddleback {
namespace {

// Windows a vertex grow with its distance from the source: hardly where saddle vertices abound, in proportion and more
// where nothing bends them and they meet behind.
constexpr double k_growth = 0.35, k_growth_where_smooth = 1.2;
// Microseconds a vertex on one machine, of which only ratios matter: a surface's layout, the guess, and windows, which
// grow by that power of the vertices that a source has; on smooth surfaces by the square root.
constexpr double k_cost_of_surface = 0.7, k_cost_of_guess = 0.35;
constexpr double k_cost_of_windows = 0.8, k_growth_of_windows = 0.15, k_cost_where_smooth = 0.045;

/// From 0, every other vertex is a saddle, as on scanned surfaces, to 1, one in four at most.
double smoothness(const Mesh& mesh) {
  Index saddles = 0;
  for (Index v = 0; v < mesh.vertex_count(); ++v) saddles += mesh.is_saddle(v);
  return std::clamp(2 - 4.0 * saddles / mesh.vertex_count(), 0.0, 1.0);
}

/// Vertices within the limit, all of them when there is none.
double vertices_within(const Mesh& mesh, double source_count, double limit) {
  const double disks = source_count * std::numbers::pi * limit * limit;
  return mesh.vertex_count() * std::min(1.0, disks / mesh.area());
}

double cost_of_windows(const Mesh& mesh, double source_count, double limit) {
  const double count = vertices_within(mesh, source_count, limit), each = std::max(1.0, count / source_count);
  const double bent = k_cost_of_windows * std::pow(each, k_growth_of_windows);
  const double smooth = std::max(bent, k_cost_where_smooth * std::sqrt(each));
  return count * (bent + smoothness(mesh) * (smooth - bent));
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
  // Only fronts of thousands of vertices run long enough for that.
  const double each = vertices_within(mesh, source_count, limit) / source_count;
  const double far = std::clamp(std::log10(each) / 2 - 1, 0.0, 1.0);
  const double growth = k_growth + far * smoothness(mesh) * k_growth_where_smooth;
  return {mesh, sources, {.limit = limit, .growth = growth}, stage.part(0, share), stage.part(share, 1)};
}

}  // namespace saddleback
