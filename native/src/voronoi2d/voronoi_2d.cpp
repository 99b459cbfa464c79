// From sites to the numbered diagram: order, sweep, stitch, place the vertices.

#include "saddleback/voronoi_2d.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "saddleback/error.h"

#include "voronoi2d/check_options.h"
#include "voronoi2d/edge_curve.h"
#include "voronoi2d/find_cells.h"
#include "voronoi2d/site_order.h"
#include "voronoi2d/twin_voronoi.h"

namespace saddleback {
namespace {

using namespace voronoi2d;

// Few enough sites for a core's cache. Tiles are squares, whose numbers of sites fall by four from size to size: a
// little more than one of these, so that a tile of evenly spread sites is one square and not a few odd ones.
Index good_circle_size(Index count) {
  constexpr double k_most = 20000, k_spread = 1.15;
  double size = count;
  while (size > k_most) size /= 4;
  return size < count ? static_cast<Index>(k_spread * size) : count;
}

Numbering find_numbering(const OrderedSites& sites, const Voronoi2dOptions& options, Cells& cells,
                         const JobStage& stage) {
  const Index circle_size = options.circles > 0 ? sites.count() / options.circles : good_circle_size(sites.count());
  const bool has_tiles = circle_size < sites.count();
  Numbering numbering;
  if (has_tiles) {
    cells = find_cells_by_tiles(sites, std::max<Index>(1, circle_size), options.threads, stage.part(0, 0.6));
    if (cells.cell_count() > 0 && number(cells, sites, options.threads, stage.part(0.6, 0.9), numbering))
      return numbering;
  }
  cells = find_cells(sites, has_tiles ? stage.part(0.9, 0.97) : stage.part(0, 0.8));
  if (!number(cells, sites, options.threads, stage.part(0.97, 1), numbering))
    throw Error("voronoi_2d: the cells of one circle do not fit together");
  return numbering;
}

}  // namespace

Voronoi2d voronoi_2d(std::span<const Vec2> sites, const Voronoi2dOptions& options, Job* job) {
  return voronoi_2d(sites, options, JobStage(job, "Voronoi diagram"));
}

Voronoi2d voronoi_2d(std::span<const Vec2> sites, const Voronoi2dOptions& options, const JobStage& stage) {
  check_options(options, sites.size());
  constexpr std::size_t k_fewest = 3;
  if (options.cuda_device >= 0 && sites.size() >= k_fewest) {
    std::optional<Voronoi2d> found = twin_voronoi(sites, options.cuda_device, stage);
    if (found) {
      stage.update(1);
      return std::move(*found);
    }
  }
  OrderedSites ordered = order_sites(sites, stage.part(0, 0.1));
  Cells cells;
  Numbering numbering = find_numbering(ordered, options, cells, stage.part(0.1, 0.95));

  Voronoi2d result;
  result.sites.assign(sites.begin(), sites.end());
  result.vertices = std::move(numbering.vertices);
  result.edges = std::move(numbering.edge_vertices);
  result.edge_sites = std::move(numbering.edge_sites);
  result.cell_places.assign(sites.size(), k_none);
  for (Index rank = 0; rank < ordered.count(); ++rank) {
    if (rank % 65536 == 0) stage.check();
    result.cell_places[ordered.original[rank]] = rank;
  }
  for (std::size_t i = 0; i < sites.size() && ordered.original.size() < sites.size(); ++i)
    result.cell_places[i] = result.cell_places[ordered.site_of[i]];
  result.site_of = std::move(ordered.site_of);
  result.cell_sites = std::move(ordered.original);
  result.cell_offsets = std::move(cells.offsets);
  result.corner_vertices = std::move(numbering.corner_vertices);
  result.side_edges = std::move(numbering.side_edges);
  stage.update(1);
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

Moments cell_moments(const Voronoi2d& diagram, Index site) {
  constexpr double k_infinity = std::numeric_limits<double>::infinity(),
                   k_nan = std::numeric_limits<double>::quiet_NaN();
  if (diagram.cell_places[site] == k_none) return {0, {k_nan, k_nan}};
  if (!diagram.is_bounded(site)) return {k_infinity, {k_nan, k_nan}};
  // Counted from the site, which keeps small cells far from the origin exact.
  const Vec2& inside = diagram.sites[site];
  const std::span<const Index> corners = diagram.cell_vertices(site), sides = diagram.cell_edges(site);
  double area = 0;
  Vec2 moment(0, 0), before = diagram.vertices[corners.back()] - inside;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2 corner = diagram.vertices[corners[i]] - inside;
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
  return {area, inside + moment / area};
}

}  // namespace

std::vector<double> Voronoi2d::areas() const {
  std::vector<double> result(sites.size());
  for (std::size_t i = 0; i < sites.size(); ++i) result[i] = cell_moments(*this, static_cast<Index>(i)).area;
  return result;
}

std::vector<Vec2> Voronoi2d::centroids() const {
  std::vector<Vec2> result(sites.size());
  for (std::size_t i = 0; i < sites.size(); ++i) result[i] = cell_moments(*this, static_cast<Index>(i)).centroid;
  return result;
}

}  // namespace saddleback
