#include "geodesics/graph/lattice.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>
#include <utility>
#include <vector>

#include "mesh/tables/outgoing.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

// Radians. What is rounded counts; what is merely nearly regular only where it is stretched: there detours are alike
// for long enough, as on wavy oblong grids.
constexpr double k_straight = 1e-5, k_nearly_straight = 0.05;
constexpr Index k_most_sampled = 1 << 13;
/// Parts of mechanical shapes are such, too; curved meshes have none but by chance.
constexpr double k_share = 0.01;
/// Bounds the share of what is nearly a lattice. Scans and remeshed models have up to a half.
constexpr double k_nearly_share = 0.6;
/// A vertex' longest edge, in its shortest ones, from which on cells are stretched: between those of squares divided by
/// diagonals and of oblongs of 3 : 1.
constexpr double k_stretched = 2.5;

/// Holds what a vertex is part of, if only to k_nearly_straight.
struct Surroundings {
  Lattice lattice = Lattice::none;
  bool nearly = false;
};

/// Holds how well another edge goes on from the target of h in the direction in which h arrives, where nothing bends
/// the surface: angles in radians.
struct GoingOn {
  double bent = std::numeric_limits<double>::infinity(), turned = std::numeric_limits<double>::infinity();
  bool is_straight(double angle) const { return bent <= angle && turned < angle; }
};

/// The directions of the edges out of hubs: from each rim vertex of a fan an edge leads there.
class Hubs {
 public:
  explicit Hubs(const Unfolding& unfolding) : unfolding_(unfolding) {
    const Mesh& mesh = unfolding.mesh();
    std::vector<Index> counts(mesh.vertex_count(), 0);
    for (Index h = 0; h < mesh.halfedge_count(); ++h)
      if (++counts[mesh.from(h)] == k_many) hubs_[mesh.from(h)] = {};
    for (auto& [vertex, hub] : hubs_) {
      double direction = 0;
      for (const Index out : outgoing(mesh, vertex)) {
        hub.ascending.push_back(direction);
        hub.of_halfedges.emplace_back(out, direction);
        direction += mesh.corner_angle(out);
      }
      std::ranges::sort(hub.of_halfedges);
    }
  }
  /// Unfolding::polar_of_reverse. O(log degree).
  double back(Index h) const {
    const Index twin = unfolding_.mesh().twin(h);
    const auto hub = hubs_.empty() || twin == k_none ? hubs_.end() : hubs_.find(unfolding_.mesh().to(h));
    if (hub == hubs_.end()) return unfolding_.polar_of_reverse(h);
    return std::ranges::lower_bound(hub->second.of_halfedges, std::pair(twin, 0.0))->second;
  }
  /// Calls use(direction) for edges out of a vertex: of a hub for those next to straight on from `back`.
  template <class Use>
  void for_each_ahead(Index vertex, double back, Use&& use) const {
    const auto hub = hubs_.empty() ? hubs_.end() : hubs_.find(vertex);
    if (hub == hubs_.end()) {
      for (const Index out : outgoing(unfolding_.mesh(), vertex)) use(unfolding_.polar(out));
      return;
    }
    for (const double ahead : {back - std::numbers::pi, back + std::numbers::pi}) {
      const std::vector<double>& ascending = hub->second.ascending;
      const auto after = std::ranges::lower_bound(ascending, ahead);
      if (after != ascending.end()) use(*after);
      if (after != ascending.begin()) use(*std::prev(after));
    }
  }

 private:
  static constexpr Index k_many = 64;
  struct Hub {
    std::vector<double> ascending;
    std::vector<std::pair<Index, double>> of_halfedges;  ///< in their order
  };
  const Unfolding& unfolding_;
  std::unordered_map<Index, Hub> hubs_;
};

GoingOn going_on(const Unfolding& unfolding, const Hubs& hubs, Index h) {
  const Mesh& mesh = unfolding.mesh();
  const Index vertex = mesh.to(h);
  if (mesh.is_boundary(vertex)) return {};
  GoingOn best{std::abs(mesh.total_angle(vertex) - 2 * std::numbers::pi)};
  if (best.bent > k_nearly_straight) return best;
  const double back = hubs.back(h);
  hubs.for_each_ahead(vertex, back, [&](double direction) {
    const double turn = std::abs(direction - back);
    best.turned = std::min(best.turned, std::abs(turn - std::numbers::pi));
  });
  return best;
}

/// An edge of a vertex: its direction there, and its length.
struct Spoke {
  double angle, length;
};

/// Returns the edges out of a vertex, counter-clockwise. O(degree)
std::vector<Spoke> spokes_of(const Mesh& mesh, Index vertex) {
  std::vector<Spoke> spokes;
  const Index first = mesh.first_halfedge(vertex);
  double angle = 0;
  for (Index h = first; h != k_none;) {
    spokes.push_back({angle, mesh.length(h)});
    angle += mesh.corner_angle(h);
    const Index last = Mesh::prev(h);
    h = mesh.rotate(h);
    if (h == k_none) spokes.push_back({mesh.total_angle(vertex), mesh.length(last)});
    if (h == first) h = k_none;
  }
  return spokes;
}

/// Tells whether two edges go straight on along a side on which all others reach as far: a flat strip one cell wide, as
/// between the rims of a lathed cylinder and between the two inmost rows of a torus. Along it the same detour follows
/// again and again.
bool is_beside_strip(const Mesh& mesh, Index vertex) {
  const std::vector<Spoke> spokes = spokes_of(mesh, vertex);
  const std::size_t count = spokes.size(), most = mesh.is_boundary(vertex) ? 1 : count;
  for (std::size_t begin = 0; begin < most; ++begin) {
    double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
    for (std::size_t i = 1; i < count; ++i) {
      const Spoke& spoke = spokes[(begin + i) % count];
      double turn = spoke.angle - spokes[begin].angle;
      if (turn < 0) turn += mesh.total_angle(vertex);
      if (turn > std::numbers::pi - k_straight) {
        const bool is_straight = turn < std::numbers::pi + k_straight;
        if (i > 2 && is_straight) return true;
        break;
      }
      const double height = spoke.length * std::sin(turn);
      nearest = std::min(nearest, height);
      farthest = std::max(farthest, height);
      if (farthest - nearest > k_straight * farthest) break;  // about the hub of a fan there are many others
    }
  }
  return false;
}

Surroundings surroundings_of(const Unfolding& unfolding, const Hubs& hubs, Index vertex) {
  const Mesh& mesh = unfolding.mesh();
  int edges = 0, straight = 0, nearly_straight = 0;
  double shortest = std::numeric_limits<double>::infinity(), longest = 0;
  for (const Index h : outgoing(mesh, vertex)) {
    ++edges;
    const GoingOn on = going_on(unfolding, hubs, h);
    straight += on.is_straight(k_straight);
    nearly_straight += on.is_straight(k_nearly_straight);
    shortest = std::min(shortest, mesh.length(h));
    longest = std::max(longest, mesh.length(h));
  }
  const bool is_strip = is_beside_strip(mesh, vertex);
  if (2 * nearly_straight < edges && !is_strip) return {};
  return {longest < k_stretched * shortest ? Lattice::even : Lattice::stretched, 2 * straight < edges && !is_strip};
}

}  // namespace

Lattice lattice_of(const Unfolding& unfolding, int threads, const JobStage& stage) {
  const Index count = unfolding.mesh().vertex_count(), stride = std::max<Index>(1, count / k_most_sampled);
  const Index looked_at = (count + stride - 1) / stride;
  const Hubs hubs(unfolding);
  std::atomic<Index> even = 0, stretched = 0, nearly_stretched = 0;
  parallel_for(looked_at, threads, 256, [&](Index i, int) {
    stage.check();
    const auto [found, nearly] = surroundings_of(unfolding, hubs, i * stride);
    if (found == Lattice::even && !nearly) ++even;
    if (found == Lattice::stretched && !nearly) ++stretched;
    if (found == Lattice::stretched) ++nearly_stretched;
  });
  if (stretched > k_share * looked_at || nearly_stretched > k_nearly_share * looked_at) return Lattice::stretched;
  return even + stretched > k_share * looked_at ? Lattice::even : Lattice::none;
}

}  // namespace saddleback
