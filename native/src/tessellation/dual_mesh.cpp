#include "saddleback/tessellation/dual_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>

#include "saddleback/error.h"

#include "tessellation/cells/cell_topology.h"
#include "tessellation/relaxation/diagram.h"

namespace saddleback {
namespace {

// Sites are added in rounds: those that mend one cell may show what is wrong beside it.
constexpr int k_repair_rounds = 40;
// New sites find their middles by a few of Lloyd's steps, but for those on the mesh's boundary.
constexpr int k_settling_steps = 3;
// Rounds in which those of the rounds before do so, too. Around narrow handles that opens elsewhere what was mended:
// from then on they stay where they have been put.
constexpr int k_settling_rounds = 8;
// The most sites that are added: for each of the given ones, and for a few of them. A strip that is narrower than its
// cells by a factor asks for about that factor, and what a hundredth of a cell matters to nobody sees.
constexpr std::size_t k_most_added_each = 10, k_most_added = 1000;

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

DualMesh dual_of(const Mesh& mesh, const GeodesicVoronoi& cells, const JobStage& stage) {
  DualMesh result;
  result.sites = cells.sites;
  for (const SurfacePoint& site : cells.sites) result.vertices.push_back(position(mesh, site));
  const PointStars stars(cells);
  Index diagonals = 0;
  for (const Index point : cells.branch_points) {
    stage.check();
    const std::vector<Index> around = cells_around(stars, point);
    diagonals += std::max<Index>(0, static_cast<Index>(around.size()) - 3);
    add_fan(around, result.vertices, result.triangles);
  }
  for (std::size_t polyline = 0; polyline < cells.edge_cells.size(); ++polyline)
    if (!cells.edge_closed[polyline]) result.edges.push_back(cells.edge_cells[polyline]);
  result.issues = find_dual_issues(mesh, cells, stage);
  const auto corners =
      static_cast<Index>(std::count_if(cells.areas.begin(), cells.areas.end(), [](double area) { return area > 0; }));
  const auto edges = static_cast<Index>(result.edges.size()) + diagonals;
  result.euler_characteristic = corners - edges + static_cast<Index>(result.triangles.size());
  return result;
}

/// Returns the places that are no site yet, each once: two cells may have been given the same corner.
std::vector<PlaceToMend> new_places(const Mesh& mesh, const SurfacePoints& sites,
                                    const std::vector<PlaceToMend>& places) {
  const auto key = [&](const SurfacePoint& point) {
    const Vec3 place =
        mesh.is_intrinsic() ? Vec3(point.face, point.barycentric[0], point.barycentric[1]) : position(mesh, point);
    return std::array{place.x(), place.y(), place.z()};
  };
  std::set<std::array<double, 3>> known;
  for (const SurfacePoint& site : sites) known.insert(key(site));
  std::vector<PlaceToMend> result;
  for (const PlaceToMend& place : places)
    if (known.insert(key(place.point)).second) result.push_back(place);
  return result;
}

DualMesh repaired(const SaddleVertexGraph& graph, const GeodesicVoronoi& cells, int threads, const JobStage& stage) {
  const Mesh& mesh = graph.mesh();
  GeodesicVoronoi current = cells;
  const std::size_t kept = cells.sites.size(), most = k_most_added + k_most_added_each * kept;
  std::vector<Index> fixed(kept);
  std::iota(fixed.begin(), fixed.end(), 0);
  CellCache cache;  // from round to round, cells away from new sites stay
  for (int round = 0; round < k_repair_rounds; ++round) {
    const std::vector<DualIssue> issues = find_dual_issues(mesh, current, stage);
    SurfacePoints sites = current.sites;
    const std::vector<PlaceToMend> more = new_places(mesh, sites, places_to_mend(mesh, current, issues));
    if (more.empty() || sites.size() + more.size() - kept > most) break;
    if (round >= k_settling_rounds) {
      fixed.resize(sites.size());
      std::iota(fixed.begin(), fixed.end(), 0);
    }
    for (const PlaceToMend& place : more) {
      if (place.is_around || is_on_boundary(mesh, place.point)) fixed.push_back(static_cast<Index>(sites.size()));
      sites.push_back(place.point);
    }
    const JobStage part = stage.part(static_cast<double>(round) / k_repair_rounds, (round + 1.0) / k_repair_rounds);
    CentroidalVoronoiOptions options;
    options.constraints.fixed = fixed;
    options.method = RelaxationMethod::lloyd;
    options.stop.max_iterations = k_settling_steps;
    options.threads = threads;
    options.cache = &cache;
    current = relaxed_cells(graph, sites, options, part);
  }
  DualMesh result = dual_of(mesh, current, stage);
  const std::size_t added = current.sites.size() - kept;
  if (!result.issues.empty()) {
    throw InputError(message("sites: no dual mesh after ", added, " more sites, of at most ", most, ": ",
                             first_issues(result.issues), "; subdivide the mesh or choose more cells"));
  }
  result.added = static_cast<Index>(added);
  result.repaired = std::make_shared<const GeodesicVoronoi>(std::move(current));
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

DualMesh dual_mesh(const Mesh& mesh, const GeodesicVoronoi& cells) { return dual_of(mesh, cells, JobStage()); }

DualMesh dual_mesh(const SaddleVertexGraph& graph, const GeodesicVoronoi& cells, DualPolicy policy, int threads,
                   Job* job) {
  const JobStage stage(job, "Making the dual mesh");
  if (policy == DualPolicy::repair) {
    DualMesh result = repaired(graph, cells, threads, stage);
    stage.update(1);
    return result;
  }
  DualMesh result = dual_of(graph.mesh(), cells, stage);
  if (policy == DualPolicy::fail && !result.issues.empty()) {
    throw InputError(message("sites: the cells have no triangulation as their dual: ", first_issues(result.issues),
                             "; use more cells, or policy='repair'"));
  }
  stage.update(1);
  return result;
}

}  // namespace saddleback
