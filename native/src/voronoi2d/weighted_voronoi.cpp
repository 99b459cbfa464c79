// From weighted sites to the numbered diagram: order, find each site's cell for itself, stitch.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "saddleback/error.h"
#include "saddleback/voronoi_2d.h"

#include "support/parallel.h"
#include "voronoi2d/check_options.h"
#include "voronoi2d/triangulation.h"
#include "voronoi2d/weighted_cell.h"
#include "voronoi2d/weighted_sites.h"

namespace saddleback {
namespace {

using namespace voronoi2d;
using Side = WeightedCell::Side;

/// Of several sides between the same two cells: where it stands among them.
struct Repeated {
  Index side, ordinal, ordinals;
};

/// Cells of some sites in a row, counter-clockwise.
struct CellLists {
  LargeArray<Index> sizes, neighbours;
  LargeArray<std::uint8_t> is_open;  ///< by side: the corner behind it is at infinity
  LargeArray<Vec2> corners;          ///< those behind whose site is the lowest of the three there
  std::vector<Repeated> repeated;
};

void append(const std::vector<Side>& sides, Index site, CellLists& out) {
  out.sizes.push_back(static_cast<Index>(sides.size()));
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const Side& side = sides[k];
    const Index next = sides[k + 1 == sides.size() ? 0 : k + 1].neighbour;
    if (side.ordinals > 1)
      out.repeated.push_back({static_cast<Index>(out.neighbours.size()), side.ordinal, side.ordinals});
    if (!side.is_open && site < side.neighbour && site < next) out.corners.push_back(side.corner);
    out.neighbours.push_back(side.neighbour);
    out.is_open.push_back(side.is_open);
  }
}

/// Finds cells, a block of sites in a row after the other.
class CellFinder {
 public:
  static constexpr Index k_block = 64;

  CellFinder(const WeightedSites& sites, const DiskTree& tree) : points_(sites.points), tree_(tree) {
    double heaviest = 0;
    for (const DiskTree::Disk& disk : tree.widest()) heaviest = std::max(heaviest, std::fabs(disk.radius));
    for (const predicates::WeightedPoint2& point : points_) heaviest = std::max(heaviest, std::fabs(point.weight));
    slack_ = k_slack * heaviest;
  }

  /// Collects the rows of sites that matter to the sites of a block, if their cells are not larger than usual.
  void open_block(Index begin, Index end) {
    double low[2] = {points_[begin].x, points_[begin].y}, high[2] = {low[0], low[1]}, lightest = points_[begin].weight;
    for (Index i = begin; i < end; ++i) {
      low[0] = std::min(low[0], points_[i].x), high[0] = std::max(high[0], points_[i].x);
      low[1] = std::min(low[1], points_[i].y), high[1] = std::max(high[1], points_[i].y);
      lightest = std::min(lightest, points_[i].weight);
    }
    const double width = high[0] - low[0], height = high[1] - low[1], x = 0.5 * (low[0] + high[0]),
                 y = 0.5 * (low[1] + high[1]);
    constexpr double k_usual = 4;  // mean distances: a cell's farthest point, twice
    usual_far_ = k_usual * std::sqrt(width / (end - begin) * height);
    const double around = 0.5 * std::sqrt(width * width + height * height) + usual_far_;
    rows_.clear();
    tree_.visit(
        [&](const DiskTree::Disk& disk) {
          return is_within(disk.x - x, disk.y - y, around + slack_ + (disk.radius - lightest));
        },
        [&](Index row) { rows_.push_back(row); });
  }

  /// Neighbours in the diagram without weights are a good guess. Then all sites that may matter.
  void find(Index site, std::span<const Index> guess, WeightedCell& cell) const {
    const predicates::WeightedPoint2& here = points_[site];
    cell.open(points_, site, guess);
    double reach = cell.far() + slack_;
    const auto may_matter = [&](double x, double y, double weight) {
      return is_within(x - here.x, y - here.y, reach + (weight - here.weight));
    };
    const auto meet_row = [&](Index row) {
      const Index end = std::min(static_cast<Index>(points_.size()), (row + 1) * DiskTree::k_fan);
      for (Index other = row * DiskTree::k_fan; other < end; ++other) {
        const predicates::WeightedPoint2& point = points_[other];
        if (!may_matter(point.x, point.y, point.weight) || other == site || cell.has_met(other)) continue;
        cell.meet(other);
        reach = cell.far() + slack_;
      }
    };
    if (cell.far() < usual_far_) {
      const std::span<const DiskTree::Disk> disks = tree_.rows();
      for (const Index row : rows_)
        if (may_matter(disks[row].x, disks[row].y, disks[row].radius)) meet_row(row);
      return;
    }
    Index entered = 0;
    constexpr Index k_few = 16;  // so many disks are looked into faster than asked about
    tree_.visit_from(
        here.x, here.y,
        [&](const DiskTree::Disk& disk) {
          if (!may_matter(disk.x, disk.y, disk.radius)) return false;
          return ++entered < k_few || cell.may_meet(disk.x, disk.y, disk.radius);
        },
        meet_row);
  }

 private:
  static constexpr double k_slack = 1e-12;  // far more than the rounding of a few operations

  static bool is_within(double x, double y, double reach) {
    return reach > 0 && x * x + y * y < reach * reach * (1 + k_slack);
  }
  std::span<const predicates::WeightedPoint2> points_;
  const DiskTree& tree_;
  double slack_ = 0;  ///< more than the rounding of a difference of weights
  double usual_far_ = 0;
  std::vector<Index> rows_;
};

/// Neighbours without weights.
NeighbourLists guess_neighbours(const WeightedSites& sites, int threads, const JobStage& stage) {
  constexpr Index k_tile = 2000;
  OrderedSites places;
  places.places = sites.places;
  for (const predicates::WeightedPoint2& point : sites.points) {
    places.x.push_back(point.x);
    places.y.push_back(point.y);
  }
  return neighbours_of(triangulate(places, k_tile, threads, stage), places);
}

/// The cells of all sites in the order of their ranks, as one list.
struct WeightedCells {
  LargeArray<Index> offsets, neighbours;
  LargeArray<std::uint8_t> is_open;
  LargeArray<Vec2> corners;
  std::vector<Repeated> repeated;
};

WeightedCells joined(std::vector<CellLists>& tiles, const JobStage& stage) {
  WeightedCells cells;
  cells.offsets.push_back(0);
  for (CellLists& tile : tiles) {
    stage.check();
    const Index begin = static_cast<Index>(cells.neighbours.size());
    for (const Index size : tile.sizes) cells.offsets.push_back(cells.offsets.back() + size);
    cells.neighbours.insert(cells.neighbours.end(), tile.neighbours.begin(), tile.neighbours.end());
    cells.is_open.insert(cells.is_open.end(), tile.is_open.begin(), tile.is_open.end());
    cells.corners.insert(cells.corners.end(), tile.corners.begin(), tile.corners.end());
    for (Repeated one : tile.repeated) {
      one.side += begin;
      cells.repeated.push_back(one);
    }
    tile = {};
  }
  return cells;
}

WeightedCells find_cells(const WeightedSites& sites, const Voronoi2dOptions& options, const JobStage& stage) {
  const Index count = sites.count();
  constexpr Index k_tile = 512;
  const Index tile_count = options.circles > 0 ? std::min(options.circles, count) : (count + k_tile - 1) / k_tile;
  const DiskTree tree(sites.points);
  const NeighbourLists guess = guess_neighbours(sites, options.threads, stage.part(0, 0.3));
  std::vector<CellLists> tiles(tile_count);
  struct Worker {
    CellFinder finder;
    WeightedCell cell{};
    std::vector<Side> sides{};
  };
  std::vector<Worker> workers(thread_count(options.threads), Worker{CellFinder(sites, tree)});
  std::atomic<Index> done{0};
  parallel_for(tile_count, options.threads, 1, [&](Index tile, int thread) {
    const auto bound = [&](Index i) { return static_cast<Index>(static_cast<std::int64_t>(count) * i / tile_count); };
    Worker& worker = workers[thread];
    CellFinder& finder = worker.finder;
    for (Index site = bound(tile); site < bound(tile + 1); ++site) {
      if (site % 16 == 0) stage.check();
      if (site == bound(tile) || site % CellFinder::k_block == 0)
        finder.open_block(site, std::min(bound(tile + 1), (site / CellFinder::k_block + 1) * CellFinder::k_block));
      const Index first = guess.offsets[site], last = guess.offsets[site + 1];
      finder.find(site, std::span(guess.neighbours).subspan(first, last - first), worker.cell);
      worker.cell.read(worker.sides);
      append(worker.sides, site, tiles[tile]);
      if (++done % k_tile == 0) stage.update(0.3 + 0.65 * done / count);
    }
  });
  return joined(tiles, stage);
}

/// Numbers edges by the lower rank beside them, vertices by the lowest about them, then counter-clockwise.
class Stitcher {
 public:
  Stitcher(const WeightedCells& cells, const WeightedSites& sites, Voronoi2d& result)
      : cells_(cells), sites_(sites), result_(result), twins_(cells.neighbours.size(), k_none) {}

  void stitch(const JobStage& stage) {
    const Index count = sites_.count();
    result_.corner_vertices.assign(twins_.size(), k_none);
    result_.side_edges.resize(twins_.size());
    result_.edges.reserve(twins_.size() / 2);
    result_.edge_sites.reserve(twins_.size() / 2);
    for (Index cell = 0; cell < count; ++cell) {
      if (cell % k_block == 0) stage.update(0.4 * cell / count);
      for_sides(cell, [&](Index side) { join_side(cell, side); });
    }
    for (Index cell = 0; cell < count; ++cell) {
      if (cell % k_block == 0) stage.update(0.4 + 0.4 * cell / count);
      for_sides(cell, [&](Index side) { add_vertex(cell, side); });
    }
    for (std::size_t edge = 0; edge < result_.edges.size(); ++edge) {
      if (edge % k_block == 0) stage.check();
      add_ends(edge);
    }
    stage.update(1);
  }

 private:
  static constexpr Index k_block = 65536;

  template <class Visit>
  void for_sides(Index cell, Visit&& visit) const {
    for (Index side = cells_.offsets[cell]; side < cells_.offsets[cell + 1]; ++side) visit(side);
  }

  [[noreturn]] static void fail() { throw Error("voronoi_2d: the cells of weighted sites do not fit together"); }

  const Repeated* repeated(Index side) const {
    const auto found = std::lower_bound(cells_.repeated.begin(), cells_.repeated.end(), side,
                                        [](const Repeated& one, Index i) { return one.side < i; });
    return found != cells_.repeated.end() && found->side == side ? &*found : nullptr;
  }

  /// The same edge from the other side: of several between the same cells the first here is the last there.
  Index twin_of(Index cell, Index side) const {
    const Repeated* const mine = cells_.repeated.empty() ? nullptr : repeated(side);
    const Index other = cells_.neighbours[side];
    for (Index twin = cells_.offsets[other]; twin < cells_.offsets[other + 1]; ++twin) {
      if (cells_.neighbours[twin] != cell) continue;
      if (!mine) return twin;
      const Repeated* const theirs = repeated(twin);
      if (!theirs || theirs->ordinals != mine->ordinals) fail();
      if (mine->ordinal + theirs->ordinal + 1 == mine->ordinals) return twin;
    }
    fail();
  }

  void join_side(Index cell, Index side) {
    const Index other = cells_.neighbours[side];
    if (other < cell) {
      if (twins_[side] == k_none) fail();
      return;
    }
    const Index twin = twin_of(cell, side);
    if (twins_[twin] != k_none) fail();
    twins_[side] = twin;
    twins_[twin] = side;
    result_.side_edges[side] = result_.side_edges[twin] = static_cast<Index>(result_.edges.size());
    result_.edges.push_back({before(cell, side), side});
    result_.edge_sites.push_back({sites_.original[cell], sites_.original[other]});
  }

  Index before(Index cell, Index side) const {
    return side == cells_.offsets[cell] ? cells_.offsets[cell + 1] - 1 : side - 1;
  }

  /// Corners are numbered as the sides before them. The next one about a vertex, counter-clockwise, is in the cell
  /// across that side.
  Index next_corner(Index corner) const { return before(cells_.neighbours[corner], twins_[corner]); }

  void add_vertex(Index cell, Index corner) {
    if (cells_.is_open[corner]) return;
    const Index last = cells_.offsets[cell + 1] - 1;
    const Index next = cells_.neighbours[corner == last ? cells_.offsets[cell] : corner + 1];
    if (cells_.neighbours[corner] < cell || next < cell) return;
    const Vec2& position = cells_.corners[corners_seen_++];
    if (result_.corner_vertices[corner] != k_none) return;
    const Index vertex = static_cast<Index>(result_.vertices.size());
    Index walk = corner;
    do {
      if (cells_.is_open[walk] || result_.corner_vertices[walk] != k_none) fail();
      result_.corner_vertices[walk] = vertex;
      walk = next_corner(walk);
    } while (walk != corner);
    result_.vertices.push_back(position / sites_.scale);
  }

  /// From the corners at the ends of an edge to their vertices.
  void add_ends(std::size_t edge) {
    std::array<Index, 2>& ends = result_.edges[edge];
    for (Index& end : ends) {
      if (!cells_.is_open[end] && result_.corner_vertices[end] == k_none) fail();
      end = result_.corner_vertices[end];
    }
    if (ends[0] == k_none) {
      std::swap(ends[0], ends[1]);
      std::swap(result_.edge_sites[edge][0], result_.edge_sites[edge][1]);
    }
  }

  const WeightedCells& cells_;
  const WeightedSites& sites_;
  Voronoi2d& result_;
  LargeArray<Index> twins_;
  std::size_t corners_seen_ = 0;
};

bool all_equal(std::span<const double> weights) {
  return std::all_of(weights.begin(), weights.end(), [&](double weight) { return weight == weights[0]; });
}

}  // namespace

Voronoi2d voronoi_2d(std::span<const Vec2> sites, std::span<const double> weights, const Voronoi2dOptions& options,
                     Job* job) {
  check_options(options, sites.size());
  const JobStage stage(job, "Weighted Voronoi diagram");
  if (weights.size() == sites.size() && all_equal(weights) && (weights.empty() || std::isfinite(weights[0])))
    return voronoi_2d(sites, options, stage);
  WeightedSites ordered = order_weighted_sites(sites, weights, options.threads, stage.part(0, 0.2));
  WeightedCells cells = find_cells(ordered, options, stage.part(0.2, 0.9));
  Voronoi2d result;
  Stitcher(cells, ordered, result).stitch(stage.part(0.9, 1));
  result.sites.assign(sites.begin(), sites.end());
  result.weights.assign(weights.begin(), weights.end());
  result.cell_places.assign(sites.size(), k_none);
  for (Index rank = 0; rank < ordered.count(); ++rank) result.cell_places[ordered.original[rank]] = rank;
  for (std::size_t i = 0; i < sites.size(); ++i) result.cell_places[i] = result.cell_places[ordered.site_of[i]];
  result.site_of = std::move(ordered.site_of);
  result.hidden = std::move(ordered.hidden);
  result.cell_sites = std::move(ordered.original);
  result.cell_offsets = std::move(cells.offsets);
  stage.update(1);
  return result;
}

}  // namespace saddleback
