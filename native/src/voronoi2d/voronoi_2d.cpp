// Leads from sites to the numbered diagram: orders, sweeps, stitches, places the vertices.

#include "saddleback/voronoi2d/voronoi_2d.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saddleback/error.h"

#include "voronoi2d/diagram/edge_curve.h"
#include "voronoi2d/diagram/half_edges.h"
#include "voronoi2d/sites/check_options.h"
#include "voronoi2d/sites/site_order.h"
#include "voronoi2d/sweep/triangulation.h"
#include "voronoi2d/voronoi_2d_cuda.h"

namespace saddleback {
namespace {

using namespace voronoi2d;

// Few enough sites for a core's cache.
Index tile_size(Index count, const Voronoi2dOptions& options) {
  constexpr Index k_good = 2000;
  return options.circles > 0 ? std::max<Index>(1, count / options.circles) : k_good;
}

/// All but the sites themselves, by the processor.
Voronoi2d find_diagram(std::span<const Vec2> sites, const Voronoi2dOptions& options, const JobStage& stage) {
  OrderedSites ordered = order_sites(sites, options.threads, stage.part(0, 0.1));
  Triangulation triangulation =
      triangulate(ordered, tile_size(ordered.count(), options), options.threads, stage.part(0.1, 0.7));
  LargeArray<std::uint32_t>().swap(ordered.places);  // others can have the room
  Numbering numbering = number(std::move(triangulation), ordered, options.threads, stage.part(0.7, 0.98));
  LargeArray<double>().swap(ordered.x);
  LargeArray<double>().swap(ordered.y);

  Voronoi2d result;
  result.site_of = smallest_equals(ordered, options.threads, stage.part(0.98, 1));
  result.vertices = std::move(numbering.vertices);
  result.edges = std::move(numbering.edge_vertices);
  result.edge_sites = std::move(numbering.edge_sites);
  result.cell_places = std::move(ordered.rank_of);
  result.cell_sites = std::move(ordered.original);
  result.cell_offsets = std::move(numbering.offsets);
  result.corner_vertices = std::move(numbering.corner_vertices);
  result.side_edges = std::move(numbering.side_edges);
  return result;
}

}  // namespace

Voronoi2d voronoi_2d(LargeArray<Vec2>&& sites, const Voronoi2dOptions& options, Job* job) {
  if (!options.cuda_devices.empty()) return voronoi_2d(std::span<const Vec2>(sites), options, job);
  check_options(options, sites.size());
  const JobStage stage(job, "Voronoi diagram");
  Voronoi2d result = find_diagram(sites, options, stage);
  result.sites = std::move(sites);
  stage.update(1);
  return result;
}

Voronoi2d voronoi_2d(std::span<const Vec2> sites, const Voronoi2dOptions& options, Job* job) {
  return voronoi_2d(sites, options, JobStage(job, "Voronoi diagram"));
}

Voronoi2d voronoi_2d(std::span<const Vec2> sites, const Voronoi2dOptions& options, const JobStage& stage) {
  check_options(options, sites.size());
  constexpr std::size_t k_fewest = 3;
  std::optional<Voronoi2d> found;
  if (!options.cuda_devices.empty() && sites.size() >= k_fewest) found = cuda_voronoi(sites, {}, options, stage);
  if (found) {
    stage.update(1);
    return std::move(*found);
  }
  LargeArray<Vec2> own = copy_of(sites, options.threads, stage.part(0, 0.01));
  Voronoi2d result = find_diagram(own, options, stage.part(0.01, 1));
  result.sites = std::move(own);
  return result;
}

std::span<const Index> Voronoi2d::cell_vertices(Index site) const {
  const Index place = cell_places[site];
  if (place == k_none) return {};
  return std::span(corner_vertices).subspan(cell_offsets[place], cell_offsets[place + 1] - cell_offsets[place]);
}

std::span<const Index> Voronoi2d::cell_edges(Index site) const {
  const Index place = cell_places[site];
  if (place == k_none) return {};
  return std::span(side_edges).subspan(cell_offsets[place], cell_offsets[place + 1] - cell_offsets[place]);
}

CellRows Voronoi2d::cells() const {
  CellRows result;
  result.offsets.reserve(sites.size() + 1);
  result.offsets.push_back(0);
  result.vertices.reserve(corner_vertices.size());
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const Index site = static_cast<Index>(i);
    if (site_of[i] == site) {
      const std::span<const Index> corners = cell_vertices(site);
      result.vertices.insert(result.vertices.end(), corners.begin(), corners.end());
    }
    result.offsets.push_back(static_cast<Index>(result.vertices.size()));
  }
  return result;
}

bool Voronoi2d::is_bounded(Index site) const {
  const std::span<const Index> corners = cell_vertices(site);
  return !corners.empty() && std::find(corners.begin(), corners.end(), k_none) == corners.end();
}

std::vector<Triangle> Voronoi2d::delaunay() const {
  std::vector<Triangle> result;
  result.reserve(2 * cell_sites.size());
  std::vector<bool> is_done(vertices.size(), false);
  std::vector<Index> around;
  for (std::size_t corner = 0; corner < corner_vertices.size(); ++corner) {
    const Index vertex = corner_vertices[corner];
    if (vertex == k_none || is_done[vertex]) continue;
    is_done[vertex] = true;
    sites_around(vertex, side_edges[corner], around);
    std::rotate(around.begin(), std::min_element(around.begin(), around.end()), around.end());
    for (std::size_t i = 1; i + 1 < around.size(); ++i) result.push_back({around[0], around[i], around[i + 1]});
  }
  return result;
}

void Voronoi2d::sites_around(Index vertex, Index edge, std::vector<Index>& around) const {
  // Counter-clockwise from cell to cell: each cell has an edge that leads to the vertex, with the next cell behind it.
  around.clear();
  Index walk = edge;
  do {
    const bool leads_there = edges[walk][1] == vertex;
    around.push_back(edge_sites[walk][leads_there ? 0 : 1]);
    const Index next = edge_sites[walk][leads_there ? 1 : 0];
    const std::span<const Index> corners = cell_vertices(next);
    walk = cell_edges(next)[std::find(corners.begin(), corners.end(), vertex) - corners.begin()];
  } while (walk != edge);
}

namespace {

struct Moments {
  double area;
  Vec2 centroid;
};

/// Moments of the cell of a site that shares none with an earlier one: edges know these alone.
Moments cell_moments(const Voronoi2d& diagram, Index site) {
  constexpr double k_infinity = std::numeric_limits<double>::infinity(),
                   k_nan = std::numeric_limits<double>::quiet_NaN();
  if (diagram.cell_places[site] == k_none) return {0, {k_nan, k_nan}};
  if (!diagram.is_bounded(site)) return {k_infinity, {k_nan, k_nan}};
  // Counted from the site, which keeps small cells far from the origin exact.
  const Vec2& inside = diagram.sites[site];
  const std::span<const Index> corners = diagram.cell_vertices(site), sides = diagram.cell_edges(site);
  double area = 0;
  Vec2 moment(0, 0), before = diagram.vertices[corners.back()] - inside, low = before, high = before;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2 corner = diagram.vertices[corners[i]] - inside;
    low = low.cwiseMin(corner), high = high.cwiseMax(corner);
    const double half = 0.5 * (before.x() * corner.y() - before.y() * corner.x());
    area += half;
    moment += half / 3 * (before + corner);
    if (!diagram.weights.empty()) {
      const Bisector curve = bisector_beside(diagram, site, sides[i]);
      const Bisector::Segment segment = curve.segment(curve.parameter(before), curve.parameter(corner));
      area += segment.area;
      moment += segment.moment;
    }
    before = corner;
  }
  // A sliver's numbers are roundings: still an area of 0 or more, and a place within the cell's box.
  if (!(area > 0)) return {0, inside + 0.5 * (low + high)};
  if (!diagram.weights.empty()) return {area, inside + moment / area};
  return {area, inside + (moment / area).cwiseMax(low).cwiseMin(high)};
}

}  // namespace

std::vector<double> Voronoi2d::areas() const {
  std::vector<double> result(sites.size());
  for (std::size_t i = 0; i < sites.size(); ++i) result[i] = cell_moments(*this, site_of[i]).area;
  return result;
}

std::vector<Vec2> Voronoi2d::centroids() const {
  std::vector<Vec2> result(sites.size());
  for (std::size_t i = 0; i < sites.size(); ++i) result[i] = cell_moments(*this, site_of[i]).centroid;
  return result;
}

}  // namespace saddleback
