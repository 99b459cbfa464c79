#include "saddleback/dual_mesh.h"

#include <algorithm>
#include <cmath>

#include "saddleback/error.h"

#include "tessellation/cell_topology.h"
#include "tessellation/diagram.h"

namespace saddleback {
namespace {

// Sites are added in rounds: those that mend one cell may show what is wrong beside it.
constexpr int k_repair_rounds = 40;
// New sites find their middles by a few of Lloyd's steps, but for those on the mesh's boundary.
constexpr int k_settling_steps = 3;

/// Twice the distance of the site from a bisector: of two mirror images in the plane of one of its straight bits, the
/// one in which the foot lies, else the one whose end is nearest to it.
double length_across(const Mesh& mesh, const GeodesicVoronoi& cells, Index polyline) {
  const Index begin = cells.edge_offsets[polyline], end = cells.edge_offsets[polyline + 1];
  double least_miss = std::numeric_limits<double>::infinity(), height = 0;
  for (Index i = begin; i + 1 < end; ++i) {
    const Index a = cells.edge_points[i], b = cells.edge_points[i + 1];
    const double length = (cells.positions[b] - cells.positions[a]).norm();
    const double from_a = cells.point_distance[a], from_b = cells.point_distance[b];
    if (!(length > 1e-6 * (from_a + from_b))) continue;  // too short to tell a direction
    const double foot = (from_a * from_a - from_b * from_b + length * length) / (2 * length);
    const double miss = std::max({0.0, -foot, foot - length});
    if (miss >= least_miss) continue;
    least_miss = miss;
    height = std::sqrt(std::max(0.0, from_a * from_a - foot * foot));
  }
  if (least_miss == std::numeric_limits<double>::infinity()) height = cells.point_distance[cells.edge_points[begin]];
  const auto [left, right] = cells.edge_cells[polyline];
  const double chord = (position(mesh, cells.sites[left]) - position(mesh, cells.sites[right])).norm();
  return std::max(2 * height, chord);
}

/// A fan from the corner that leaves the shortest diagonals.
void add_fan(const std::vector<Index>& around, const std::vector<Vec3>& vertices, std::vector<Triangle>& triangles) {
  const std::size_t count = around.size();
  std::size_t apex = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < count && count > 3; ++a) {
    double sum = 0;
    for (const Index other : around) sum += (vertices[around[a]] - vertices[other]).norm();
    if (sum < least) least = sum, apex = a;
  }
  for (std::size_t i = 1; i + 1 < count; ++i) {
    triangles.push_back({around[apex], around[(apex + i) % count], around[(apex + i + 1) % count]});
  }
}

std::string first_issues(const std::vector<DualIssue>& issues) {
  constexpr std::size_t k_named = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(k_named, issues.size()); ++i) {
    text += (i > 0 ? "; " : "") + to_string(issues[i]);
  }
  return issues.size() > k_named ? text + message("; and ", issues.size() - k_named, " more") : text;
}

DualMesh repaired(const SaddleVertexGraph& graph, const GeodesicVoronoi& cells, int threads, const JobStage& stage) {
  const Mesh& mesh = graph.mesh();
  GeodesicVoronoi current = cells;
  const auto kept = static_cast<Index>(cells.sites.size());
  std::vector<Index> fixed(kept);
  for (Index i = 0; i < kept; ++i) fixed[i] = i;
  for (int round = 0; round < k_repair_rounds; ++round) {
    const std::vector<DualIssue> issues = find_dual_issues(mesh, current);
    if (issues.empty()) break;
    SurfacePoints sites = current.sites;
    const SurfacePoints more = places_to_mend(issues, static_cast<Index>(sites.size()));
    for (const SurfacePoint& place : more) {
      if (is_on_boundary(mesh, place)) fixed.push_back(static_cast<Index>(sites.size()));
      sites.push_back(place);
    }
    const JobStage part = stage.part(static_cast<double>(round) / k_repair_rounds, (round + 1.0) / k_repair_rounds);
    CentroidalVoronoiOptions options;
    options.fixed = fixed;
    options.method = RelaxationMethod::lloyd;
    options.max_iterations = k_settling_steps;
    options.threads = threads;
    current = relax_sites(graph, sites, options, part).cells;
  }
  DualMesh result = dual_mesh(mesh, current);
  if (!result.issues.empty()) {
    throw InputError(message("sites: no dual mesh after ", current.sites.size() - kept, " more sites: ",
                             first_issues(result.issues), "; subdivide the mesh or choose more cells"));
  }
  result.added = static_cast<Index>(current.sites.size()) - kept;
  return result;
}

}  // namespace

std::string to_string(DualIssue::Kind kind) {
  switch (kind) {
    case DualIssue::Kind::not_a_disk:
      return "not_a_disk";
    case DualIssue::Kind::two_borders:
      return "two_borders";
    case DualIssue::Kind::closed_boundary:
      return "closed_boundary";
    case DualIssue::Kind::double_boundary:
      return "double_boundary";
    case DualIssue::Kind::cell_meets_itself:
      return "cell_meets_itself";
    case DualIssue::Kind::few_corners:
      return "few_corners";
  }
  return {};
}

std::string to_string(const DualIssue& issue) {
  switch (issue.kind) {
    case DualIssue::Kind::not_a_disk:
      return message("cell ", issue.cell, " is not a disk");
    case DualIssue::Kind::two_borders:
      return message("cell ", issue.cell, " meets the mesh's boundary more than once");
    case DualIssue::Kind::closed_boundary:
      return message("cells ", issue.cell, " and ", issue.other, " meet along a closed curve");
    case DualIssue::Kind::double_boundary:
      return message("cells ", issue.cell, " and ", issue.other, " meet along more than one curve");
    case DualIssue::Kind::cell_meets_itself:
      return message("cell ", issue.cell, " meets itself at a branch point");
    case DualIssue::Kind::few_corners:
      return message("cell ", issue.cell, " has fewer than three corners");
  }
  return {};
}

DualMesh dual_mesh(const Mesh& mesh, const GeodesicVoronoi& cells) {
  DualMesh result;
  result.sites = cells.sites;
  for (const SurfacePoint& site : cells.sites) result.vertices.push_back(position(mesh, site));
  const PointStars stars(cells);
  Index diagonals = 0;
  for (const Index point : cells.branch_points) {
    const std::vector<Index> around = cells_around(stars, point);
    diagonals += std::max<Index>(0, static_cast<Index>(around.size()) - 3);
    add_fan(around, result.vertices, result.triangles);
  }
  for (Index polyline = 0; polyline < static_cast<Index>(cells.edge_cells.size()); ++polyline) {
    if (cells.edge_closed[polyline]) continue;
    result.edges.push_back(cells.edge_cells[polyline]);
    result.edge_lengths.push_back(length_across(mesh, cells, polyline));
  }
  result.issues = find_dual_issues(mesh, cells);
  const auto corners =
      static_cast<Index>(std::count_if(cells.areas.begin(), cells.areas.end(), [](double area) { return area > 0; }));
  const auto edges = static_cast<Index>(result.edges.size()) + diagonals;
  result.euler_characteristic = corners - edges + static_cast<Index>(result.triangles.size());
  return result;
}

DualMesh dual_mesh(const SaddleVertexGraph& graph, const GeodesicVoronoi& cells, DualPolicy policy, int threads,
                   Job* job) {
  const JobStage stage(job, "Making the dual mesh");
  if (policy == DualPolicy::repair) {
    DualMesh result = repaired(graph, cells, threads, stage);
    stage.update(1);
    return result;
  }
  DualMesh result = dual_mesh(graph.mesh(), cells);
  if (policy == DualPolicy::fail && !result.issues.empty()) {
    throw InputError(message("sites: the cells have no triangulation as their dual: ", first_issues(result.issues),
                             "; use more cells, or policy='repair'"));
  }
  stage.update(1);
  return result;
}

}  // namespace saddleback
