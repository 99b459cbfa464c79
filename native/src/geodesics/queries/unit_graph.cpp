#include "geodesics/queries/unit_graph.h"

#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "saddleback/error.h"

#include "geodesics/unfolding/common_length.h"

namespace saddleback {
namespace {

// Coordinates of scaled copies differ by 2^-52, so that one of 2^26 is rounded to another multiple of this: few meshes
// have one. As fine as the single precision that most meshes were stored with.
constexpr int k_grid_bits = 26;
// What is nearer than this below a multiple is rounded up to it. With a half, coordinates with one bit more, of which
// meshes that were stored in single precision have hundreds, would go either way.
constexpr double k_round_up = 0.71828;
// Of the grid: what all but a few edges must be longer than, so that rounding does not show.
constexpr double k_shortest_edge = 1 << 9;
constexpr double k_short_share = 0.01;

/// Graphs that take more are not made twice: the memory would count for more than a pattern that stays.
constexpr std::size_t k_largest = std::size_t{128} << 20;

struct Box {
  Vec3 center;
  double half;  ///< of its longest side
};

Box box_of(const Mesh& mesh) {
  Vec3 least = mesh.position(0), most = least;
  for (const Vec3& place : mesh.positions()) {
    least = least.cwiseMin(place);
    most = most.cwiseMax(place);
  }
  return {0.5 * (least + most), 0.5 * (most - least).maxCoeff()};
}

/// Three a vertex, in the cube.
std::vector<double> rounded_coordinates(const Mesh& mesh, const Box& box) {
  std::vector<double> xyz;
  xyz.reserve(3 * mesh.positions().size());
  for (const Vec3& place : mesh.positions()) {
    for (int axis = 0; axis < 3; ++axis) {
      const double share = (place[axis] - box.center[axis]) / box.half;
      xyz.push_back(std::ldexp(std::floor(std::ldexp(share, k_grid_bits) + k_round_up), -k_grid_bits));
    }
  }
  return xyz;
}

bool is_same(const Mesh& mesh, std::span<const double> xyz) {
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    for (int axis = 0; axis < 3; ++axis)
      if (mesh.position(v)[axis] != xyz[3 * v + axis]) return false;
  return true;
}

/// None where it is in the cube already, or rounding spoils it.
std::optional<Mesh> mesh_in_cube(const Mesh& mesh, const Box& box, const JobStage& stage) {
  if (edge_length_at(mesh, k_short_share) < std::ldexp(k_shortest_edge * box.half, -k_grid_bits)) return {};
  const std::vector<double> xyz = rounded_coordinates(mesh, box);
  if (is_same(mesh, xyz)) return {};
  const std::span<const Triangle> triangles = mesh.triangles();
  try {
    return Mesh(xyz, {triangles.data()->data(), 3 * triangles.size()}, stage);
  } catch (const MeshError&) {
    return {};  // a needle lost its area
  }
}

SaddleVertexGraphOptions same_rule(const SaddleVertexGraph& graph, int threads, int cuda_device) {
  SaddleVertexGraphOptions options{
      .k = graph.k(), .accuracy = graph.accuracy(), .exact = graph.is_exact(), .threads = threads};
  if (cuda_device >= 0 && !graph.is_exact()) options.cuda_devices = {cuda_device};
  return options;
}

}  // namespace

UnitGraph::UnitGraph(Mesh there, double the_size, const SaddleVertexGraph& like, int threads, int cuda_device,
                     const JobStage& stage)
    : mesh(std::move(there)), size(the_size), graph(mesh, same_rule(like, threads, cuda_device), stage) {}

std::unique_ptr<const UnitGraph> unit_graph(const SaddleVertexGraph& graph, int threads, int cuda_device,
                                            const JobStage& stage) {
  constexpr double k_mesh_share = 0.1;
  if (graph.nbytes() > k_largest) return {};
  const Box box = box_of(graph.mesh());
  std::optional<Mesh> mesh = mesh_in_cube(graph.mesh(), box, stage.part(0, k_mesh_share));
  if (!mesh) return {};
  try {
    return std::make_unique<const UnitGraph>(std::move(*mesh), box.half, graph, threads, cuda_device,
                                             stage.part(k_mesh_share, 1));
  } catch (const InputError&) {
    return {};  // the memory does not do for a second exact graph
  }
}

}  // namespace saddleback
