#include "geodesics/exact_progress.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "geodesics/angle_defect.h"

namespace saddleback {
namespace {

// Microseconds on one machine, of which only ratios matter. What a vertex takes of a surface's layout and of the
// forecast grows with the mesh, as less of it stays in caches.
constexpr double k_cost_of_surface = 0.030, k_cost_of_forecast = 0.045, k_growth_by_caches = 0.25;
constexpr double k_cost_of_window = 0.045;
constexpr double k_sorting = 0.6;  ///< a window, of its cost

// Windows a vertex, before they are foretold: they grow with the square root of the vertices that a source has, which
// is how many a ray passes, the slower the more the surface bends light.
constexpr double k_at_vertex = 13;
constexpr double k_where_smooth = 0.75, k_less_a_decade = 0.27, k_least = 0.1;
constexpr double k_smooth = 1e-3;  ///< mean_angle_defect

double growth_of_windows(const Mesh& mesh) {
  const double decades = std::log10(std::max(1.0, mean_angle_defect(mesh) / k_smooth));
  return std::max(k_least, k_where_smooth - k_less_a_decade * decades);
}

/// The vertices that sources reach, and how many of them the source of one has, in the mean over them all.
struct Reach {
  double vertices = 0, a_source = 1;
};

/// From a sample, in space: each belongs to the nearest source, if that is within the limit and on the same component.
Reach reach_of(const ExactWork& work) {
  constexpr std::size_t k_samples = 1024, k_most_sources = 512;  // of more, some stand for all
  const Mesh& mesh = work.mesh;
  const std::size_t every = 1 + work.sources.size() / k_most_sources;
  std::vector<Vec3> places;
  std::vector<Index> components;
  for (std::size_t i = 0; i < work.sources.size(); i += every) {
    places.push_back(position(mesh, work.sources[i]));
    components.push_back(mesh.component_of(mesh.triangles()[work.sources[i].face][0]));
  }
  // Disks of those that stand for others hold the others' as well.
  const double limit = work.limit * work.limit * static_cast<double>(every);
  std::vector<double> owned(places.size(), 0.0);
  const Index stride = std::max<Index>(1, mesh.vertex_count() / static_cast<Index>(k_samples));
  for (Index v = 0; v < mesh.vertex_count(); v += stride) {
    double least = limit;
    std::size_t nearest = places.size();
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double distance = (mesh.position(v) - places[i]).squaredNorm();
      if (distance > least || components[i] != mesh.component_of(v)) continue;
      least = distance;
      nearest = i;
    }
    if (nearest < places.size()) owned[nearest] += stride;
  }
  Reach reach;
  double squares = 0;
  for (const double count : owned) {
    reach.vertices += count;
    squares += count * count;
  }
  if (reach.vertices > 0) reach.a_source = std::max(1.0, squares / reach.vertices / static_cast<double>(every));
  return reach;
}

double likely_windows(const Mesh& mesh, const Reach& reach) {
  return reach.vertices * (k_at_vertex + growth_of_windows(mesh) * std::sqrt(reach.a_source));
}

double by_caches(const Mesh& mesh) { return std::pow(mesh.vertex_count(), k_growth_by_caches); }

}  // namespace

ExactProgress::ExactProgress(const ExactWork& work, const JobStage& stage) : work_(work), stage_(stage) {
  if (!stage.is_watched()) return;
  const double surface = k_cost_of_surface * by_caches(work.mesh) * work.mesh.vertex_count();
  const Reach reach = reach_of(work);
  before_windows_ = surface + k_cost_of_forecast * by_caches(work.mesh) * reach.vertices;
  const double all = before_windows_ + cost_of_windows(likely_windows(work.mesh, reach));
  laid_ = surface / all;
  foretold_ = before_windows_ / all;
}

double ExactProgress::cost_of_windows(double count) const {
  return k_cost_of_window * (work_.sorts_windows ? 1 + k_sorting : 1) * count;
}

void ExactProgress::foretell(const ExactSurface& surface, double ring_width) {
  if (!stage_.is_watched()) return;
  forecast_ = WindowForecast(surface, work_.sources, {work_.limit, ring_width}, stage_.part(laid_, foretold_));
  per_ring_ = 1 / ring_width;
  // By now it is known better what the time so far is a share of.
  const double windows = k_cost_of_window * forecast_.total(),
               all = before_windows_ + cost_of_windows(forecast_.total());
  run_ = (before_windows_ + windows) / all;
  running_ = stage_.part(before_windows_ / all, run_);
}

void ExactProgress::update(double distance, std::int64_t window_count) {
  running_.check();
  if (!stage_.is_watched()) return;
  const auto ring = static_cast<std::size_t>(std::lround(distance * per_ring_)),
             windows = static_cast<std::size_t>(window_count);
  if (ring != ring_) {
    ring_ = ring;
    before_ring_ = windows;
  }
  // Within a ring windows count as much as those before it did.
  const double before = forecast_.before(ring), foretold = forecast_.before(ring + 1) - before;
  const double each = before_ring_ > 0 ? before / static_cast<double>(before_ring_) : 1;
  const double within = std::min(foretold, each * static_cast<double>(windows - before_ring_));
  running_.update((before + within) / forecast_.total());
}

void ExactProgress::end() {
  running_.update(1);
  forecast_ = {};
}

}  // namespace saddleback
