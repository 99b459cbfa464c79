// A start for cells of a fine mesh: cells relaxed on a mesh of its samples, joined where their own cells meet. The
// iterations there take a tenth of the time or less, and the energy of the cells hardly depends on the vertices.

#include <algorithm>
#include <optional>

#include "saddleback/error.h"

#include "tessellation/log_map/tangent_moves.h"
#include "tessellation/relaxation/diagram.h"

namespace saddleback {
namespace {

constexpr Index k_least = 10'000, k_for_a_cell = 20;  // vertices of the coarse mesh
constexpr Index k_worth = 5;                          // times as many vertices: finding the samples' cells takes time

/// Tells whether some part of the mesh has too few of them to have its shape.
bool is_any_part_poor(const Mesh& mesh, const SurfacePoints& samples) {
  constexpr Index k_few = 20;
  std::vector<Index> in_part(mesh.component_count(), 0);
  for (const SurfacePoint& sample : samples) ++in_part[mesh.component_of(mesh.triangles()[sample.face][0])];
  return std::ranges::any_of(in_part, [](Index count) { return count < k_few; });
}

/// The density at points; none where it is uniform.
std::vector<double> density_at(const Mesh& mesh, const SurfacePoints& points, std::span<const double> density) {
  std::vector<double> values;
  if (density.empty()) return values;
  for (const SurfacePoint& point : points) {
    const Triangle& t = mesh.triangles()[point.face];
    values.push_back(point.barycentric.dot(Vec3(density[t[0]], density[t[1]], density[t[2]])));
  }
  return values;
}

/// The place on the mesh of one on the coarse mesh: from the nearest corner, which is a sample, along the surface.
SurfacePoints moved_back(const Mesh& mesh, const SurfacePoints& samples, const Mesh& coarse,
                         const SurfacePoints& places, int threads) {
  SurfacePoints sites;
  TangentField steps;
  for (const SurfacePoint& place : places) {
    int corner = 0;
    place.barycentric.maxCoeff(&corner);
    const Index nearest = coarse.triangles()[place.face][corner];
    sites.push_back(samples[nearest]);
    steps.push_back(in_chart(mesh, sites.back().face, position(coarse, place) - coarse.position(nearest)));
  }
  return move_sites(mesh, sites, steps, threads).sites;
}

}  // namespace

std::optional<SurfacePoints> coarse_mesh_sites(const SaddleVertexGraph& graph, Index count,
                                               const CentroidalVoronoiOptions& options, std::uint64_t seed,
                                               const JobStage& stage) {
  const Mesh& mesh = graph.mesh();
  const std::int64_t wanted = std::max<std::int64_t>(k_least, std::int64_t{k_for_a_cell} * count);
  if (mesh.is_intrinsic() || !options.constraints.fixed.empty() || mesh.vertex_count() < k_worth * wanted)
    return std::nullopt;
  const SurfacePoints samples = initial_sites(mesh, static_cast<Index>(wanted), options.density, seed);
  if (is_any_part_poor(mesh, samples)) return std::nullopt;
  const GeodesicVoronoi cells = find_cells(graph, samples, options.threads, options.cuda_device, stage.part(0, 0.3));
  const DualMesh dual = dual_mesh(mesh, cells);
  if (!dual.issues.empty()) return std::nullopt;  // parts of the surface are too thin for it
  const std::span places(dual.vertices.front().data(), 3 * dual.vertices.size());
  const std::span corners(dual.triangles.front().data(), 3 * dual.triangles.size());
  std::optional<Mesh> coarse;
  try {
    coarse.emplace(places, corners, stage.part(0.3, 0.32));
  } catch (const MeshError&) {  // triangles without an area
    return std::nullopt;
  }
  const SaddleVertexGraph coarse_graph(*coarse, {.threads = options.threads}, stage.part(0.32, 0.4));
  const std::vector<double> density = density_at(mesh, samples, options.density);
  CentroidalVoronoiOptions rough = options;
  rough.density = density;
  rough.start.from = RelaxationStart::From::automatic;
  rough.closed_ball = false;
  rough.cache = nullptr;
  rough.watch = nullptr;
  rough.stop.return_when_cancelled = false;
  const CentroidalVoronoi relaxed = relax_count(coarse_graph, count, seed, rough, stage.part(0.4, 1));
  return moved_back(mesh, samples, *coarse, relaxed.sites, options.threads);
}

}  // namespace saddleback
