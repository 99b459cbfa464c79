// A start with few irregular vertices: cells relaxed at a quarter of the number, then a new site on every boundary
// between two of them. Where six cells meet a cell, six will meet each of the four that it becomes.

#include <algorithm>
#include <cmath>

#include "saddleback/sample.h"
#include "saddleback/surface_curve.h"

#include "tessellation/cell_topology.h"
#include "tessellation/diagram.h"

namespace saddleback {
namespace {

// Fewer cells than this are relaxed from a sample: their irregular vertices are few and find their places.
constexpr Index k_coarsest = 60;
constexpr int k_most_coarse_iterations = 40, k_first_iterations = 5;
constexpr double k_coarse_tolerance = 1e-5;

Index euler_characteristic(const Mesh& mesh) { return mesh.vertex_count() - mesh.edge_count() + mesh.face_count(); }

/// Half way along a boundary between two cells.
SurfacePoint middle_of(const Mesh& mesh, const GeodesicVoronoi& cells, Index polyline) {
  const Index begin = cells.edge_offsets[polyline], end = cells.edge_offsets[polyline + 1];
  const auto length = [&](Index i) {
    return (cells.positions[cells.edge_points[i + 1]] - cells.positions[cells.edge_points[i]]).norm();
  };
  double left = 0;
  for (Index i = begin; i + 1 < end; ++i) left += length(i) / 2;
  Index i = begin;
  while (i + 2 < end && left > length(i)) left -= length(i++);
  const SurfacePoint &a = cells.points[cells.edge_points[i]], &b = cells.points[cells.edge_points[i + 1]];
  const Index face = shared_face(mesh, a, b);
  if (face == k_none) return a;
  const double share = length(i) > 0 ? std::clamp(left / length(i), 0.0, 1.0) : 0;
  const Vec3 place = (1 - share) * *barycentric_in(mesh, a, face) + share * *barycentric_in(mesh, b, face);
  return {face, normalised_barycentric(place)};
}

/// The coarse sites, then one for each boundary, evenly left out where they are too many, sampled where too few.
SurfacePoints refined(const Mesh& mesh, const GeodesicVoronoi& cells, Index count,
                      const CentroidalVoronoiOptions& options, std::uint64_t seed) {
  SurfacePoints sites = cells.sites;
  const auto boundaries = static_cast<Index>(cells.edge_cells.size());
  const Index wanted = count - static_cast<Index>(sites.size()), taken = std::min(wanted, boundaries);
  for (Index i = 0; i < taken; ++i) {
    sites.push_back(middle_of(mesh, cells, static_cast<Index>(static_cast<std::int64_t>(i) * boundaries / taken)));
  }
  if (wanted > taken) {
    const SurfacePoints more = sample(mesh, {.count = wanted - taken, .density = options.density, .seed = seed});
    sites.insert(sites.end(), more.begin(), more.end());
  }
  return sites;
}

SurfacePoints start(const SaddleVertexGraph& graph, Index count, const CentroidalVoronoiOptions& options,
                    std::uint64_t seed, const JobStage& stage) {
  const Mesh& mesh = graph.mesh();
  // A triangulation of n vertices has 3 n - 3 chi edges.
  const Index coarse = (count + 3 * euler_characteristic(mesh)) / 4;
  if (coarse < std::max(k_coarsest, mesh.component_count())) return initial_sites(mesh, count, options.density, seed);
  CentroidalVoronoiOptions rough = options;
  rough.fixed = {};
  rough.max_iterations = std::min(options.max_iterations, k_most_coarse_iterations);
  rough.tolerance = std::max(options.tolerance, k_coarse_tolerance);
  rough.return_when_cancelled = false;
  const SurfacePoints sites = start(graph, coarse, options, seed, stage.part(0, 0.5));
  // Round thin parts coarse cells meet themselves or each other twice; what is between them says nothing there.
  CentroidalVoronoiOptions first = rough;
  first.max_iterations = std::min(rough.max_iterations, k_first_iterations);
  CentroidalVoronoi relaxed = relax_sites(graph, sites, first, stage.part(0.5, 0.6));
  if (!find_dual_issues(mesh, relaxed.cells).empty()) return initial_sites(mesh, count, options.density, seed);
  relaxed = relax_sites(graph, relaxed.sites, rough, stage.part(0.6, 1));
  return refined(mesh, relaxed.cells, count, options, seed);
}

}  // namespace

SurfacePoints coarse_to_fine_sites(const SaddleVertexGraph& graph, Index count, const CentroidalVoronoiOptions& options,
                                   std::uint64_t seed, const JobStage& stage) {
  return start(graph, count, options, seed, stage);
}

}  // namespace saddleback
