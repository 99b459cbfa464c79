#include "geodesics/lattice.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "support/parallel.h"

namespace saddleback {
namespace {

// Radians. What is rounded counts; what is merely nearly regular only where it is stretched: there detours are alike
// for long enough, as on wavy oblong grids.
constexpr double k_straight = 1e-5, k_nearly_straight = 0.05;
constexpr Index k_most_sampled = 1 << 13;
/// Parts of mechanical shapes are such, too; curved meshes have none but by chance.
constexpr double k_share = 0.01;
/// Of what is nearly a lattice. Scans and remeshed models have up to a half.
constexpr double k_nearly_share = 0.6;
/// A vertex' longest edge, in its shortest ones, from which on cells are stretched: between those of squares divided by
/// diagonals and of oblongs of 3 : 1.
constexpr double k_stretched = 2.5;

/// What a vertex is part of, if only to k_nearly_straight.
struct Surroundings {
  Lattice lattice = Lattice::none;
  bool nearly = false;
};

/// How well another edge goes on from the target of h in the direction in which h arrives, where nothing bends the
/// surface: angles in radians.
struct GoingOn {
  double bent = std::numeric_limits<double>::infinity(), turned = std::numeric_limits<double>::infinity();
  bool is_straight(double angle) const { return bent <= angle && turned < angle; }
};

GoingOn going_on(const Unfolding& unfolding, Index h) {
  const Mesh& mesh = unfolding.mesh();
  const Index vertex = mesh.to(h);
  if (mesh.is_boundary(vertex)) return {};
  GoingOn best{std::abs(mesh.total_angle(vertex) - 2 * std::numbers::pi)};
  if (best.bent > k_nearly_straight) return best;
  const double back = unfolding.polar_of_reverse(h);
  const Index first = mesh.first_halfedge(vertex);
  Index out = first;
  do {
    const double turn = std::abs(unfolding.polar(out) - back);
    best.turned = std::min(best.turned, std::abs(turn - std::numbers::pi));
    out = mesh.rotate(out);
  } while (out != k_none && out != first);
  return best;
}

/// Whether two edges of a saddle go straight on along one of its sides: the border of a flat strip, as between the two
/// inmost rows of a torus. Shortest paths stay within it, one cell wide, and have the same detour again and again.
bool is_beside_strip(const Unfolding& unfolding, Index vertex) {
  const Mesh& mesh = unfolding.mesh();
  const double total = mesh.total_angle(vertex);
  if (mesh.is_boundary(vertex) || total < 2 * std::numbers::pi + k_straight) return false;
  const Index first = mesh.first_halfedge(vertex);
  Index a = first;
  do {
    for (Index b = mesh.rotate(a); b != first; b = mesh.rotate(b)) {
      const double turn = unfolding.polar(b) - unfolding.polar(a);
      if (std::abs(turn - std::numbers::pi) < k_straight || std::abs(total - turn - std::numbers::pi) < k_straight)
        return true;
    }
    a = mesh.rotate(a);
  } while (a != first);
  return false;
}

Surroundings surroundings_of(const Unfolding& unfolding, Index vertex) {
  const Mesh& mesh = unfolding.mesh();
  int edges = 0, straight = 0, nearly_straight = 0;
  double shortest = std::numeric_limits<double>::infinity(), longest = 0;
  const Index first = mesh.first_halfedge(vertex);
  Index h = first;
  do {
    ++edges;
    const GoingOn on = going_on(unfolding, h);
    straight += on.is_straight(k_straight);
    nearly_straight += on.is_straight(k_nearly_straight);
    shortest = std::min(shortest, mesh.length(h));
    longest = std::max(longest, mesh.length(h));
    h = mesh.rotate(h);
  } while (h != k_none && h != first);
  const bool is_strip = is_beside_strip(unfolding, vertex);
  if (2 * nearly_straight < edges && !is_strip) return {};
  return {longest < k_stretched * shortest ? Lattice::even : Lattice::stretched, 2 * straight < edges && !is_strip};
}

}  // namespace

Lattice lattice_of(const Unfolding& unfolding, int threads, const JobStage& stage) {
  const Index count = unfolding.mesh().vertex_count(), stride = std::max<Index>(1, count / k_most_sampled);
  const Index looked_at = (count + stride - 1) / stride;
  std::atomic<Index> even = 0, stretched = 0, nearly_stretched = 0;
  parallel_for(looked_at, threads, 256, [&](Index i, int) {
    stage.check();
    const auto [found, nearly] = surroundings_of(unfolding, i * stride);
    if (found == Lattice::even && !nearly) ++even;
    if (found == Lattice::stretched && !nearly) ++stretched;
    if (found == Lattice::stretched) ++nearly_stretched;
  });
  if (stretched > k_share * looked_at || nearly_stretched > k_nearly_share * looked_at) return Lattice::stretched;
  return even + stretched > k_share * looked_at ? Lattice::even : Lattice::none;
}

}  // namespace saddleback
