#include "geodesics/exact/exact_progress.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "geodesics/unfolding/angle_defect.h"
#include "geodesics/unfolding/needles.h"

namespace saddleback {
namespace {

// Microseconds on one machine, of which only ratios matter: a vertex in the surface's layout, in the forecast, when it
// is reached, and when it bends what reaches it; and a window.
constexpr double k_cost_of_surface = 0.5, k_cost_of_forecast = 0.95, k_cost_of_vertex = 0.38, k_cost_of_bend = 1.5;
constexpr double k_cost_of_window = 0.058;
/// A face whose corners lie far from each other in memory takes so much longer to lay out.
constexpr double k_cost_of_far_corners = 0.7;
// Of running with windows that are kept, until sorting was tried.
constexpr double k_sorting = 0.6, k_keeping = 1.7;  ///< the latter in times of running without keeping

/// Sources that have fewer vertices, in the mean, run no longer than their forecast would.
constexpr double k_worth_forecast = 1000;

/// Windows a vertex, before they are foretold: about as many as a ray passes vertices of its source, until the surface
/// bends cone so much that they meet others.
double likely_windows(const Mesh& mesh, double vertices_a_source) {
  constexpr double k_least = 4, k_growth = 0.52, k_power = 0.54, k_last = 1;
  const double straight = k_least + k_growth * std::pow(vertices_a_source, k_power);
  const double bent = k_last * edges_until_bent(mesh);
  return straight * bent / std::hypot(straight, bent);
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

/// Share of the faces whose corners are no neighbors in memory, nor in a cache.
double share_of_far_corners(const Mesh& mesh) {
  constexpr Index k_samples = 4096, k_far = 1 << 15;
  const Index stride = std::max<Index>(1, mesh.face_count() / k_samples);
  double far = 0, count = 0;
  for (Index face = 0; face < mesh.face_count(); face += stride) {
    const auto [first, last] = std::minmax_element(mesh.triangles()[face].begin(), mesh.triangles()[face].end());
    far += *last - *first > k_far;
    ++count;
  }
  return far / count;
}

/// The vertices that sources reach, and how many of them the source of one has, in the mean over them all.
struct Reach {
  double held = 0;                    ///< on components with sources
  double vertices = 0, a_source = 1;  ///< at least 1
};

/// From a sample, in space: each belongs to the nearest source, if that is within the limit and on the same component.
Reach reach_of(const ExactWork& work) {
  constexpr std::size_t k_samples = 1024, k_most_sources = 512;  // of more, some stand for all
  const Mesh& mesh = work.mesh;
  const std::size_t every = 1 + work.sources.size() / k_most_sources;
  std::vector<Vec3> places;
  std::vector<Index> components;
  std::vector<bool> is_held(mesh.component_count(), false);
  for (std::size_t i = 0; i < work.sources.size(); i += every) {
    places.push_back(position(mesh, work.sources[i]));
    components.push_back(mesh.component_of(mesh.triangles()[work.sources[i].face][0]));
    is_held[components.back()] = true;
  }
  // Disks of those that stand for others hold the others' as well.
  constexpr double k_straighter = 0.9;  // lines through space than ways along a common surface
  const double limit = std::pow(k_straighter * work.limit, 2) * static_cast<double>(every);
  std::vector<double> owned(places.size(), 0.0);
  const Index stride = std::max<Index>(1, mesh.vertex_count() / static_cast<Index>(k_samples));
  Reach reach;
  for (Index v = 0; v < mesh.vertex_count(); v += stride) {
    if (!is_held[mesh.component_of(v)]) continue;
    reach.held += stride;
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
  double squares = 0;
  for (const double count : owned) {
    reach.vertices += count;
    squares += count * count;
  }
  reach.held = std::max(1.0, reach.held);
  reach.vertices = std::max(1.0, reach.vertices);
  reach.a_source = std::max(1.0, squares / reach.vertices / static_cast<double>(every));
  return reach;
}

}  // namespace

ExactProgress::ExactProgress(const ExactWork& work, const JobStage& stage) : work_(work), stage_(stage) {
  if (!stage.is_watched()) return;
  const Mesh& mesh = work.mesh;
  const Reach reach = reach_of(work);
  likely_vertices_ = reach.vertices;
  const bool goes_far = has_needles(mesh);  // vertices are reached long before their windows end
  is_foretold_ = reach.a_source >= k_worth_forecast || goes_far;
  const double at_vertices = (k_cost_of_vertex + k_cost_of_bend * bending_share(mesh)) * reach.vertices;
  const double windows = reach.vertices * likely_windows(mesh, goes_far ? reach.vertices : reach.a_source);
  of_surface_ = k_cost_of_surface * (1 + k_cost_of_far_corners * share_of_far_corners(mesh)) * reach.held;
  of_forecast_ = is_foretold_ ? k_cost_of_forecast * reach.vertices : 0;
  sorting_ = work.sorts_windows ? k_sorting : 0;
  of_running_ = (work.sorts_windows ? k_keeping : 1) * (at_vertices + k_cost_of_window * windows);
  laid_ = of_surface_ / (of_surface_ + of_forecast_ + (1 + sorting_) * of_running_);
}

void ExactProgress::foretell(const ExactSurface& surface, double ring_width) {
  if (!stage_.is_watched()) return;
  per_ring_ = 1 / ring_width;
  const double laid = clock_.seconds();
  double speed = laid / of_surface_;
  if (is_foretold_) {
    const double ahead = speed * of_forecast_, all = laid + ahead + speed * (1 + sorting_) * of_running_;
    const WindowForecast::Extent extent{work_.limit, ring_width, likely_vertices_, k_cost_of_vertex / k_cost_of_window,
                                        k_cost_of_bend / k_cost_of_window};
    forecast_ = WindowForecast(surface, work_.sources, extent, stage_.part(laid / all, (laid + ahead) / all));
    of_running_ = (work_.sorts_windows ? k_keeping : 1) * k_cost_of_window * forecast_.total();
    speed = (clock_.seconds() - laid) / of_forecast_;  // as little held up by memory as windows are
  }
  began_ = clock_.seconds();
  expected_ = speed * of_running_;
}

void ExactProgress::update(const Done& done) {
  constexpr std::int64_t k_blocks_a_look = 16;
  stage_.check();
  if (!stage_.is_watched() || done.blocks % k_blocks_a_look != 0) return;
  // What was expected counts as much as this share of the work: less than where is told how far it has come.
  const double belief = is_foretold_ ? 0.05 : 0.25;
  const double share = is_foretold_ ? share_by_rings(done) : share_by_vertices(done), so_far = clock_.seconds();
  const double running = (so_far - began_ + belief * expected_) / (share + belief);
  if (tried_ > 0)
    sorting_ = trying_ / static_cast<double>(tried_) * static_cast<double>(done.windows) / (so_far - began_);
  run_ = so_far / (so_far + running * (1 - share) + sorting_ * running);
  stage_.update(run_);
}

void ExactProgress::kept(std::int64_t windows, std::size_t bytes) {
  if (tried_ == 0) return;
  const double needed = static_cast<double>(windows) * static_cast<double>(needed_) / static_cast<double>(tried_);
  pages_.extend(static_cast<std::size_t>(needed) * bytes);
}

void ExactProgress::tried_sorting(std::int64_t windows, std::int64_t needed, double seconds) {
  tried_ += windows;
  needed_ += needed;
  trying_ += seconds;
}

/// About each source windows are the more the farther they are from it. Those of vertices that are reached may be due
/// yet: with many sources most of them.
double ExactProgress::share_by_vertices(const Done& done) const {
  constexpr double k_growth = 1.4, k_growth_to_limit = 1.55;  // there windows of vertices beyond it are not due
  const double growth = std::isinf(work_.limit) ? k_growth : k_growth_to_limit;
  const double share = std::min(1.0, static_cast<double>(done.vertices) / likely_vertices_);
  const auto blocks = static_cast<double>(done.blocks), left = static_cast<double>(done.blocks_left);
  return std::pow(left > 0 ? share * blocks / (blocks + left) : share, growth);
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
  return (before + within) / std::max(1.0, forecast_.total());
}

void ExactProgress::end() {
  if (!stage_.is_watched()) return;
  const double so_far = clock_.seconds(), running = so_far - began_;
  run_ = so_far / (so_far + sorting_ * running);
  stage_.update(run_);
  forecast_ = {};
  pages_.release();
}

}  // namespace saddleback
