// A start with few irregular vertices: cells relaxed at a quarter of the number, then a new site on every boundary
// between two of them. Where six cells meet a cell, six will meet each of the four that it becomes.

#include <algorithm>
#include <cmath>

#include "saddleback/mesh/sample.h"

#include "tessellation/cells/cell_topology.h"
#include "tessellation/relaxation/diagram.h"

namespace saddleback {
namespace {

// Fewer cells than this are relaxed from a sample: their irregular vertices are few and find their places.
constexpr Index k_coarsest = 60;
constexpr int k_most_coarse_iterations = 40, k_first_iterations = 5;
constexpr double k_coarse_tolerance = 1e-5;
constexpr double k_most_faulty = 0.2;  // of the coarse cells

Index euler_characteristic(const Mesh& mesh) { return mesh.vertex_count() - mesh.edge_count() + mesh.face_count(); }

/// Cells that are no disks, or meet others as they should not: what lies between them says nothing there.
std::vector<std::uint8_t> faulty_cells(const Mesh& mesh, const GeodesicVoronoi& cells) {
  std::vector<std::uint8_t> faulty(cells.areas.size(), 0);
  for (const DualIssue& issue : find_dual_issues(mesh, cells)) {
    faulty[issue.cell] = 1;
    if (issue.other != k_none) faulty[issue.other] = 1;
  }
  return faulty;
}

/// The density at the vertices of some cells, 0 elsewhere; at all where those have no vertex.
std::vector<double> density_within(const GeodesicVoronoi& cells, const std::vector<std::uint8_t>& chosen,
                                   std::span<const double> density) {
  std::vector<double> within(cells.vertex_cell.size(), 1.0);
  if (!density.empty()) within.assign(density.begin(), density.end());
  const std::vector<double> all = within;
  for (std::size_t v = 0; v < within.size(); ++v)
    if (!chosen[cells.vertex_cell[v]]) within[v] = 0;
  return std::ranges::any_of(within, [](double d) { return d > 0; }) ? within : all;
}

/// The coarse sites, then one for each boundary between two cells that are not both faulty, evenly left out where they
/// are too many; the rest sampled, in the faulty cells where there are any.
SurfacePoints refined(const Mesh& mesh, const GeodesicVoronoi& cells, const std::vector<std::uint8_t>& faulty,
                      Index count, const CentroidalVoronoiOptions& options, std::uint64_t seed) {
  SurfacePoints sites = cells.sites;
  std::vector<Index> boundaries;
  for (Index i = 0; i < static_cast<Index>(cells.edge_cells.size()); ++i) {
    const auto [a, b] = cells.edge_cells[i];
    if (!faulty[a] || !faulty[b]) boundaries.push_back(i);
  }
  const auto there = static_cast<std::int64_t>(boundaries.size());
  const Index wanted = count - static_cast<Index>(sites.size());
  const auto taken = static_cast<Index>(std::min<std::int64_t>(wanted, there));
  for (std::int64_t i = 0; i < taken; ++i)
    sites.push_back(point_along(mesh, cells, boundaries[i * there / taken], 0.5));
  if (wanted > taken) {
    const std::vector<double> density = density_within(cells, faulty, options.density);
    const SurfacePoints more = sample(mesh, {.count = wanted - taken, .density = density, .seed = seed});
    sites.insert(sites.end(), more.begin(), more.end());
  }
  return sites;
}

SurfacePoints start(const SaddleVertexGraph& graph, Index count, const CentroidalVoronoiOptions& options,
                    std::uint64_t seed, const JobStage& stage) {
  const Mesh& mesh = graph.mesh();
  // A triangulation of n vertices has 3 n - 3 chi edges.
  const Index coarse = (count + 3 * euler_characteristic(mesh)) / 4;
  // Of many parts, each a disk or a sphere, there would be no fewer.
  if (coarse >= count || coarse < std::max(k_coarsest, mesh.component_count()))
    return initial_sites(mesh, count, options.density, seed);
  CentroidalVoronoiOptions rough = options;
  rough.constraints.fixed = {};
  rough.start.annealing = 0;
  rough.closed_ball = false;
  rough.stop.max_iterations = std::min(options.stop.max_iterations, k_most_coarse_iterations);
  rough.stop.tolerance = std::max(options.stop.tolerance, k_coarse_tolerance);
  rough.stop.return_when_cancelled = false;
  rough.watch = nullptr;
  rough.cache = nullptr;
  const SurfacePoints sites = start(graph, coarse, options, seed, stage.part(0, 0.5));
  // Round thin parts coarse cells meet themselves or each other twice; where many do, they are no start for others.
  CentroidalVoronoiOptions first = rough;
  first.stop.max_iterations = std::min(rough.stop.max_iterations, k_first_iterations);
  GeodesicVoronoi cells = relaxed_cells(graph, sites, first, stage.part(0.5, 0.6));
  const auto faulty = std::ranges::count(faulty_cells(mesh, cells), 1);
  if (static_cast<double>(faulty) > k_most_faulty * coarse) return initial_sites(mesh, count, options.density, seed);
  cells = relaxed_cells(graph, cells.sites, rough, stage.part(0.6, 1));
  return refined(mesh, cells, faulty_cells(mesh, cells), count, options, seed);
}

}  // namespace

SurfacePoints coarse_to_fine_sites(const SaddleVertexGraph& graph, Index count, const CentroidalVoronoiOptions& options,
                                   std::uint64_t seed, const JobStage& stage) {
  return start(graph, count, options, seed, stage);
}

}  // namespace saddleback
