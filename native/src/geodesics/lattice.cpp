#include "geodesics/lattice.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace saddleback {
namespace {

constexpr double k_straight = 1e-5;  ///< radians: what is rounded counts, what is merely nearly regular does not
constexpr Index k_most_sampled = 1 << 13;
/// Parts of mechanical shapes are such, too; curved meshes have none but by chance.
constexpr double k_share = 0.01;

/// Whether another edge leaves the target of h in the direction in which h arrives, where nothing bends the surface.
bool goes_straight_on(const Unfolding& unfolding, Index h) {
  const Mesh& mesh = unfolding.mesh();
  const Index vertex = mesh.to(h);
  constexpr double k_turn = 2 * std::numbers::pi;
  if (mesh.is_boundary(vertex) || std::abs(mesh.total_angle(vertex) - k_turn) > k_straight) return false;
  const double back = unfolding.polar_of_reverse(h);
  const Index first = mesh.first_halfedge(vertex);
  Index out = first;
  do {
    const double turn = std::abs(unfolding.polar(out) - back);
    if (std::abs(turn - std::numbers::pi) < k_straight) return true;
    out = mesh.rotate(out);
  } while (out != k_none && out != first);
  return false;
}

bool is_lattice_vertex(const Unfolding& unfolding, Index vertex) {
  const Mesh& mesh = unfolding.mesh();
  int edges = 0, straight = 0;
  const Index first = mesh.first_halfedge(vertex);
  Index h = first;
  do {
    ++edges;
    straight += goes_straight_on(unfolding, h);
    h = mesh.rotate(h);
  } while (h != k_none && h != first);
  return 2 * straight >= edges;
}

}  // namespace

bool has_lattice(const Unfolding& unfolding, const JobStage& stage) {
  const Index count = unfolding.mesh().vertex_count(), stride = std::max<Index>(1, count / k_most_sampled);
  Index looked_at = 0, found = 0;
  for (Index vertex = 0; vertex < count; vertex += stride, ++looked_at) {
    if (looked_at % 1024 == 0) stage.check();
    found += is_lattice_vertex(unfolding, vertex);
  }
  return found > k_share * looked_at;
}

}  // namespace saddleback
