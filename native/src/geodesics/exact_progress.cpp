#include "geodesics/exact_progress.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "geodesics/angle_defect.h"

namespace saddleback {
namespace {

// Microseconds on one machine, of which only ratios matter: a vertex in the surface's layout, in the forecast, when it
// is reached, and when it bends what reaches it. They grow with the mesh, as less of it stays in caches.
constexpr double k_cost_of_surface = 0.3, k_cost_of_forecast = 0.55, k_cost_of_vertex = 0.3, k_cost_of_bend = 1.6;
constexpr double k_cost_of_window = 0.038;
constexpr double k_keeping = 1, k_sorting = 1.6;  ///< a window that is kept, in times its cost
constexpr double k_usual_vertices = 35e3;

/// Sources that have fewer vertices, in the mean, run no longer than their forecast would.
constexpr double k_worth_forecast = 1000;

// Windows a vertex, before they are foretold: they grow with the square root of the vertices that a source has, which
// is how many a ray passes, the slower the more the surface bends light.
constexpr double k_where_smooth = 0.53, k_less_a_decade = 0.19, k_least = 0.07;
constexpr double k_smooth = 1e-3;  ///< mean_angle_defect

double growth_of_windows(const Mesh& mesh) {
  const double decades = std::log10(std::max(1.0, mean_angle_defect(mesh) / k_smooth));
  return std::max(k_least, k_where_smooth - k_less_a_decade * decades);
}

/// Share of the vertices where a shortest path may bend.
double bending_share(const Mesh& mesh) {
  constexpr Index k_samples = 4096;
  const Index stride = std::max<Index>(1, mesh.vertex_count() / k_samples);
  double bending = 0, count = 0;
  for (Index v = 0; v < mesh.vertex_count(); v += stride) {
    bending += mesh.is_saddle(v) || mesh.is_boundary(v);
    ++count;
  }
  return bending / count;
}

/// Among needles vertices are reached long before their windows end.
bool has_needles(const Mesh& mesh) {
  constexpr Index k_samples = 4096;
  constexpr double k_long = 20, k_share = 0.1;
  const Index stride = std::max<Index>(1, mesh.face_count() / k_samples);
  double needles = 0, count = 0;
  for (Index face = 0; face < mesh.face_count(); face += stride) {
    const double longest = std::max({mesh.length(3 * face), mesh.length(3 * face + 1), mesh.length(3 * face + 2)});
    needles += longest * longest > 2 * k_long * mesh.face_area(face);
    ++count;
  }
  return needles > k_share * count;
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

double by_caches(double vertices, double power) { return std::pow(vertices / k_usual_vertices, power); }

}  // namespace

ExactProgress::ExactProgress(const ExactWork& work, const JobStage& stage) : work_(work), stage_(stage) {
  if (!stage.is_watched()) return;
  const Mesh& mesh = work.mesh;
  const Reach reach = reach_of(work);
  const double slower = by_caches(reach.vertices, 0.5);  // what is out of reach stays out of caches
  const double surface = k_cost_of_surface * by_caches(mesh.vertex_count(), 1.0 / 3) * mesh.vertex_count();
  likely_vertices_ = reach.vertices;
  is_foretold_ = reach.a_source >= k_worth_forecast || has_needles(mesh);
  cost_of_vertex_ = k_cost_of_vertex * slower;
  cost_of_bend_ = k_cost_of_bend * slower;
  at_vertices_ = (cost_of_vertex_ + cost_of_bend_ * bending_share(mesh)) * reach.vertices;
  at_windows_ = k_cost_of_window * growth_of_windows(mesh) * std::sqrt(reach.a_source) * reach.vertices;
  before_windows_ =
      surface + (is_foretold_ ? k_cost_of_forecast * by_caches(reach.vertices, 0.25) * reach.vertices : 0);
  const double all = before_windows_ + whole_cost(at_vertices_ + at_windows_);
  laid_ = surface / all;
  foretold_ = before_windows_ / all;
}

double ExactProgress::whole_cost(double of_running) const {
  return of_running * (work_.sorts_windows ? 1 + k_keeping + k_sorting : 1);
}

void ExactProgress::foretell(const ExactSurface& surface, double ring_width) {
  if (!stage_.is_watched()) return;
  double running = at_vertices_ + at_windows_;
  if (is_foretold_) {
    const WindowForecast::Extent extent{work_.limit, ring_width, likely_vertices_, cost_of_vertex_ / k_cost_of_window,
                                        cost_of_bend_ / k_cost_of_window};
    forecast_ = WindowForecast(surface, work_.sources, extent, stage_.part(laid_, foretold_));
    running = k_cost_of_window * forecast_.total();
  }
  per_ring_ = 1 / ring_width;
  // By now it is known better what the time so far is a share of.
  const double whole = whole_cost(running), all = before_windows_ + whole;
  const double sorted = work_.sorts_windows ? whole * k_sorting / (1 + k_keeping + k_sorting) : 0;
  run_ = (all - sorted) / all;
  running_ = stage_.part(before_windows_ / all, run_);
}

void ExactProgress::update(const Done& done) {
  running_.check();
  if (!stage_.is_watched()) return;
  running_.update(is_foretold_ ? share_by_rings(done) : share_by_vertices(done));
}

/// About each source windows are the more the farther they are from it. Those of vertices that are reached may be due
/// yet: with many sources most of them.
double ExactProgress::share_by_vertices(const Done& done) const {
  const double share = std::min(1.0, static_cast<double>(done.vertices) / std::max(1.0, likely_vertices_));
  const double reached = (at_vertices_ * share + at_windows_ * share * std::sqrt(share)) / (at_vertices_ + at_windows_);
  const auto blocks = static_cast<double>(done.blocks), left = static_cast<double>(done.blocks_left);
  return reached * blocks / (blocks + left);
}

double ExactProgress::share_by_rings(const Done& done) {
  const auto ring = static_cast<std::size_t>(std::lround(done.distance * per_ring_)),
             windows = static_cast<std::size_t>(done.windows);
  if (ring != ring_) {
    ring_ = ring;
    before_ring_ = windows;
  }
  // Within a ring windows count as much as those before it did.
  const double before = forecast_.before(ring), foretold = forecast_.before(ring + 1) - before;
  const double each = before_ring_ > 0 ? before / static_cast<double>(before_ring_) : 1;
  const double within = std::min(foretold, each * static_cast<double>(windows - before_ring_));
  return (before + within) / forecast_.total();
}

void ExactProgress::end() {
  running_.update(1);
  forecast_ = {};
}

}  // namespace saddleback
