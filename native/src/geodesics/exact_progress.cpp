#include "geodesics/exact_progress.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>

#include "geodesics/edge_ways.h"
#include "mesh/hilbert.h"

namespace saddleback {
namespace {

/// A way in which flows may go on: whether what finds few vertices farther out is lost, and what is lost an edge.
struct FlowRule {
  double least_outlet;  ///< sum of squared cosines to farther neighbours below which a vertex hands on less
  double loss;
  double belief;  ///< before anything is seen
};
// An inner vertex of an even mesh has an outlet of 1.4.
constexpr double k_outlet = 1.4, k_no_outlet = 0.01;
constexpr double k_loss = 0.1;
constexpr FlowRule k_rules[] = {
    {k_no_outlet, 0, 0.5}, {k_no_outlet, k_loss, 1}, {k_outlet, 0, 1}, {k_outlet, k_loss, 1}};
// On closed surfaces that bend light nowhere all of it comes together behind: there the first rule is the likely one.
constexpr double k_more_belief_where_closed = 2;
// How far the counted windows may be from a forecast that is believed, as a share of those so far.
constexpr double k_doubt = 0.08;
constexpr double k_rings_per_edge = 4;
constexpr std::size_t k_most_rings = 1 << 16;  ///< farther vertices go into the last one
constexpr std::size_t k_most_counts = 64;
constexpr Index k_vertices_a_check = 4096;
constexpr double k_growth_between_counts = 1.01;

// Microseconds a vertex on one machine, of which only ratios matter. Those of a surface's layout and of the guess grow
// with the mesh, as less of it stays in caches; those of windows by that power of the vertices that a source has, up to
// a bound where light is bent often, and by the square root where it is not.
constexpr double k_cost_of_surface = 0.030, k_cost_of_guess = 0.027, k_growth_by_caches = 0.25;
constexpr double k_cost_of_windows = 0.52, k_growth_of_windows = 0.2, k_most_windows = 4;
constexpr double k_cost_where_smooth = 0.38, k_growth_where_smooth = 0.03;

/// From 0, every other vertex is a saddle, as on scanned surfaces, to 1, one in four at most.
double smoothness(const Mesh& mesh) {
  Index saddles = 0;
  for (Index v = 0; v < mesh.vertex_count(); ++v) saddles += mesh.is_saddle(v);
  return std::clamp(2 - 4.0 * saddles / mesh.vertex_count(), 0.0, 1.0);
}

/// Vertices of the components that hold sources.
double vertices_in_reach(const Mesh& mesh, const SurfacePoints& sources) {
  if (mesh.component_count() == 1) return mesh.vertex_count();
  std::vector<bool> holds_sources(mesh.component_count(), false);
  for (const SurfacePoint& source : sources) holds_sources[mesh.component_of(mesh.triangles()[source.face][0])] = true;
  return static_cast<double>(
      std::ranges::count_if(mesh.components(), [&](Index component) { return holds_sources[component]; }));
}

/// Of these, the vertices within the limit, all of them when there is none.
double vertices_within(const Mesh& mesh, const SurfacePoints& sources, double limit) {
  const double disks = static_cast<double>(sources.size()) * std::numbers::pi * limit * limit;
  return std::min(vertices_in_reach(mesh, sources), mesh.vertex_count() * disks / mesh.area());
}

double cost_of_windows(const Mesh& mesh, const SurfacePoints& sources, double limit) {
  const double count = vertices_within(mesh, sources, limit);
  const double each = std::max(1.0, count / static_cast<double>(sources.size()));
  const double bent = std::min(k_most_windows, k_cost_of_windows * std::pow(each, k_growth_of_windows));
  const double smooth = k_cost_where_smooth + k_growth_where_smooth * std::sqrt(each);
  return count * (bent + smoothness(mesh) * (smooth - bent));
}

double by_caches(const Mesh& mesh) { return std::pow(mesh.vertex_count(), k_growth_by_caches); }

double cost_of_guess(const Mesh& mesh, const SurfacePoints& sources, double limit) {
  return k_cost_of_guess * by_caches(mesh) * vertices_within(mesh, sources, limit);
}

}  // namespace

double share_of_surface(const Mesh& mesh, const SurfacePoints& sources, double limit) {
  const double surface = k_cost_of_surface * by_caches(mesh) * mesh.vertex_count();
  return surface / (surface + cost_of_guess(mesh, sources, limit) + cost_of_windows(mesh, sources, limit));
}

ExactProgress::ExactProgress(const ExactSurface& surface, const SurfacePoints& sources, double limit,
                             const JobStage& stage) {
  static_assert(std::size(k_rules) == k_ways);
  if (!stage.is_watched()) return;
  const double guess = cost_of_guess(surface.mesh(), sources, limit);
  const double before = guess / (guess + cost_of_windows(surface.mesh(), sources, limit));
  running_ = stage.part(before, 1);
  spread_flows(surface, sources, limit, stage.part(0, before));
  for (int i = 0; i < k_ways; ++i) beliefs_[i] = k_rules[i].belief;
  if (surface.mesh().boundary_loops().empty()) beliefs_[0] += k_more_belief_where_closed * smoothness(surface.mesh());
  per_ring_ = k_rings_per_edge / surface.mesh().mean_edge_length();
}

void ExactProgress::spread_flows(const ExactSurface& surface, const SurfacePoints& sources, double limit,
                                 const JobStage& stage) {
  const Mesh& mesh = surface.mesh();
  const double per_edge = k_straighter / mesh.mean_edge_length();
  const std::vector<double> ways = ways_along_edges(mesh, sources, limit / k_straighter, stage.part(0, 0.5));
  std::vector<std::uint64_t> keys(ways.size());
  std::ranges::transform(ways, keys.begin(), [](double way) { return std::bit_cast<std::uint64_t>(way); });
  flows_.assign(ways.size(), {});
  const JobStage spreading = stage.part(0.5, 1);
  Index done = 0;
  for (const Index v : order_of(keys, stage)) {
    if (std::isinf(ways[v])) break;
    if (done++ % k_vertices_a_check == 0) spreading.update(static_cast<double>(done) / mesh.vertex_count());
    Flows& flow = flows_[surface.vertex_of(v)];
    double outlet = 0;
    const auto for_farther = [&](auto&& use) {
      for_neighbours(mesh, v, [&](Index other, Index h) {
        const double step = ways[other] - ways[v], cosine = step / mesh.length(h);
        if (step > 0 && !std::isinf(step)) use(other, step, cosine * cosine);
      });
    };
    for_farther([&](Index, double, double weight) { outlet += weight; });
    for (int i = 0; i < k_ways; ++i) totals_[i] += flow[i] += 1;
    for_farther([&](Index other, double step, double weight) {
      Flows& next = flows_[surface.vertex_of(other)];
      for (int i = 0; i < k_ways; ++i) {
        const double kept = 1 / (1 + k_rules[i].loss * step * per_edge);
        next[i] += static_cast<float>(flow[i] * kept * weight / std::max(outlet, k_rules[i].least_outlet));
      }
    });
  }
}

std::size_t ExactProgress::ring_of(double distance) const {
  return static_cast<std::size_t>(std::min(distance * per_ring_, static_cast<double>(k_most_rings)));
}

// Half of a vertex's flow counts when it is reached, by windows that go ahead, and half when all are as far.
void ExactProgress::reach(Index vertex, double distance) {
  if (flows_.empty()) return;
  const std::size_t ring = std::max(ring_, ring_of(distance));
  if (ring >= pending_.size()) pending_.resize(ring + 1, Sums{});
  for (int i = 0; i < k_ways; ++i) {
    const double half = flows_[vertex][i] / 2;
    done_[i] += half;
    pending_[ring][i] += half;
  }
}

void ExactProgress::update(double distance, std::int64_t window_count) {
  if (flows_.empty()) return;
  const std::size_t until = std::min(ring_of(distance), pending_.size());
  for (; ring_ < until; ++ring_)
    for (int i = 0; i < k_ways; ++i) done_[i] += pending_[ring_][i];
  running_.check();
  const auto windows = static_cast<double>(window_count);
  if (windows < (counts_.empty() ? 1 : counts_.back().windows * k_growth_between_counts)) return;
  remember(windows);
  running_.update(share());
}

/// Every other count is dropped when there are too many.
void ExactProgress::remember(double windows) {
  if (counts_.size() == k_most_counts) {
    for (std::size_t i = 0; i < k_most_counts / 2; ++i) counts_[i] = counts_[2 * i + 1];
    counts_.resize(k_most_counts / 2);
  }
  counts_.push_back({windows, done_});
}

/// Of all forecasts, each believed as far as its flow has risen like the windows so far.
double ExactProgress::share() const {
  constexpr double k_least_belief = 1e-9;
  const Count& now = counts_.back();
  Sums shares;
  for (int i = 0; i < k_ways; ++i) shares[i] = totals_[i] > 0 ? std::min(1.0, now.flows[i] / totals_[i]) : 0;
  const double seen = std::reduce(shares.begin(), shares.end()) / k_ways;  // little of it tells little
  double sum = 0, beliefs = 0;
  for (int i = 0; i < k_ways; ++i) {
    if (shares[i] == 0) continue;
    double apart = 0;
    for (const Count& then : counts_)
      apart = std::max(apart, std::abs(then.windows / now.windows - then.flows[i] / now.flows[i]));
    const double doubt = apart / k_doubt;
    const double belief = beliefs_[i] * std::exp(-doubt * doubt * seen) + k_least_belief;
    sum += belief * shares[i];
    beliefs += belief;
  }
  return beliefs > 0 ? sum / beliefs : 0;
}

}  // namespace saddleback
