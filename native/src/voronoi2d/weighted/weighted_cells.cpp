#include "voronoi2d/weighted/weighted_cells.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <span>

#include "saddleback/error.h"

#include "support/threads/parallel.h"
#include "voronoi2d/sites/for_pieces.h"

namespace saddleback::voronoi2d {
namespace {

/// Finds cells, a block of sites in a row after the other.
class CellFinder {
 public:
  CellFinder(const WeightedSites& sites, const DiskTree& tree, double heaviest)
      : points_(sites.points), tree_(tree), slack_(k_slack * heaviest) {}

  /// Collects the rows of sites that matter to the sites of a block, if their cells are not larger than usual.
  void open_block(Index begin, Index end) {
    const WeightedBox block(points_.subspan(begin, end - begin));
    const double width = block.high[0] - block.low[0], height = block.high[1] - block.low[1],
                 x = 0.5 * (block.low[0] + block.high[0]), y = 0.5 * (block.low[1] + block.high[1]);
    constexpr double k_usual = 4;  // mean distances: a cell's farthest point, twice
    usual_far_ = k_usual * std::sqrt(width / (end - begin) * height);
    const double around = 0.5 * std::sqrt(width * width + height * height) + usual_far_;
    rows_.clear();
    tree_.visit(
        [&](const DiskTree::Disk& disk) {
          return is_within(disk.x - x, disk.y - y, around + slack_ + (disk.radius - block.lightest));
        },
        [&](Index row) { rows_.push_back(row); });
  }

  /// Neighbors in the diagram without weights are a good guess. Then all sites that may matter.
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
  double slack_;  ///< more than the rounding of a difference of weights
  double usual_far_ = 0;
  std::vector<Index> rows_;
};

/// The largest size of a weight or of the radius of a disk about all.
double heaviest_of(const WeightedSites& sites, const DiskTree& tree) {
  double result = 0;
  for (const DiskTree::Disk& disk : tree.widest()) result = std::max(result, std::fabs(disk.radius));
  for (const predicates::WeightedPoint2& point : sites.points) result = std::max(result, std::fabs(point.weight));
  return result;
}

OrderedSites places_of(const WeightedSites& sites, int threads) {
  OrderedSites result;
  result.places.resize(sites.points.size());
  result.x.resize(sites.points.size());
  result.y.resize(sites.points.size());
  for_pieces(sites.points.size(), threads, {}, [&](Index, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      result.places[i] = sites.places[i];
      result.x[i] = sites.points[i].x;
      result.y[i] = sites.points[i].y;
    }
  });
  return result;
}

[[noreturn]] void fail() { throw Error("voronoi_2d: the cells of weighted sites do not fit together"); }

}  // namespace

WeightedCells::WeightedCells(const WeightedSites& sites, Index tile_size, int threads, const JobStage& stage)
    : sites_(sites),
      tree_(sites.points, threads),
      heaviest_(heaviest_of(sites, tree_)),
      threads_(threads),
      exact_of_(sites.count(), k_none) {
  const OrderedSites places = places_of(sites_, threads_);
  Triangulation triangulation = triangulate(places, tile_size, threads_, stage.part(0, 0.5));
  if (triangulation.is_line) {
    line_ = neighbors_of(triangulation, places, stage.part(0.5, 0.8));
  } else {
    mesh_.emplace(std::move(triangulation), sites_.points);
    mesh_->improve(threads_, stage.part(0.5, 0.8));
  }
  std::vector<Index> wanted;
  for (Index site = 0; site < sites_.count(); ++site)
    if (!mesh_ || !mesh_->is_certain(site)) wanted.push_back(site);
  double done = 0.8;
  while (!wanted.empty()) {
    const double next = 0.5 * (done + 1);
    find_exactly(wanted, stage.part(done, next));
    if (!mesh_) break;
    wanted = misfits(wanted, stage);
    done = next;
  }
  place_exact_cells(stage);
  stage.update(1);
}

void WeightedCells::find_exactly(const std::vector<Index>& wanted, const JobStage& stage) {
  const Index first = static_cast<Index>(exact_.size());
  exact_.resize(exact_.size() + wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) exact_of_[wanted[i]] = first + static_cast<Index>(i);
  struct alignas(k_apart) Worker {
    CellFinder finder;
    WeightedCell cell;
    std::vector<Index> guess{};
  };
  std::vector<Worker> workers(thread_count(threads_),
                              Worker{CellFinder(sites_, tree_, heaviest_), WeightedCell(stage)});
  const Index count = static_cast<Index>(wanted.size()), blocks = (count + k_few - 1) / k_few;
  std::atomic<Index> done{0};
  parallel_for(blocks, threads_, 1, [&](Index block, int thread) {
    Worker& worker = workers[thread];
    const Index begin = block * k_few, end = std::min(count, begin + k_few);
    const bool is_dense = wanted[end - 1] - wanted[begin] < 4 * (end - begin);
    worker.finder.open_block(wanted[begin], is_dense ? wanted[end - 1] + 1 : wanted[begin] + 1);
    for (Index i = begin; i < end; ++i) {
      if (i % 16 == 0) stage.check();
      std::vector<Index>& guess = worker.guess;
      guess.clear();
      visit_guess(wanted[i], [&](Index neighbor) {
        stage.check();
        if (std::find(guess.begin(), guess.end(), neighbor) == guess.end()) guess.push_back(neighbor);
      });
      worker.finder.find(wanted[i], worker.guess, worker.cell);
      worker.cell.read(exact_[first + i].sides);
    }
    stage.update((done += end - begin) / static_cast<double>(count));
  });
}

template <class Visit>
void WeightedCells::visit_guess(Index site, Visit&& visit) const {
  if (!mesh_) {
    for (Index i = line_.offsets[site]; i < line_.offsets[site + 1]; ++i) visit(line_.neighbors[i]);
    return;
  }
  mesh_->visit_ring(site, [&](Index neighbor, Index) {
    if (neighbor != far_away()) visit(neighbor);
  });
}

namespace {

/// Tells whether a neighbor stands once in both rings, between the same ones.
bool fits(Index neighbor, const std::vector<Index>& in_mesh, const std::vector<Index>& in_cell) {
  const auto first = std::find(in_mesh.begin(), in_mesh.end(), neighbor),
             second = std::find(in_cell.begin(), in_cell.end(), neighbor);
  if (first == in_mesh.end() || second == in_cell.end()) return false;
  if (std::find(first + 1, in_mesh.end(), neighbor) != in_mesh.end() ||
      std::find(second + 1, in_cell.end(), neighbor) != in_cell.end())
    return false;
  const auto before = [](const std::vector<Index>& ring, auto at) {
    return at == ring.begin() ? ring.back() : *(at - 1);
  };
  const auto after = [](const std::vector<Index>& ring, auto at) {
    return at + 1 == ring.end() ? ring.front() : *(at + 1);
  };
  return before(in_mesh, first) == before(in_cell, second) && after(in_mesh, first) == after(in_cell, second);
}

}  // namespace

/// Sites whose cells in the mesh do not fit to cells that have just been found.
std::vector<Index> WeightedCells::misfits(const std::vector<Index>& found, const JobStage& stage) {
  struct alignas(k_apart) Worker {
    std::vector<Index> misfits{}, in_mesh{}, in_cell{};
  };
  std::vector<Worker> workers(thread_count(threads_));
  parallel_for(static_cast<Index>(found.size()), threads_, k_few, [&](Index i, int thread) {
    const Index site = found[i];
    auto& [misfits, in_mesh, in_cell] = workers[thread];
    in_mesh.clear();
    in_cell.clear();
    mesh_->visit_ring(site, [&](Index neighbor, Index) { in_mesh.push_back(neighbor); });
    for (const WeightedCell::Side& side : exact_[exact_of_[site]].sides) {
      in_cell.push_back(side.neighbor);
      if (side.is_open) in_cell.push_back(far_away());
    }
    const auto check = [&](Index neighbor) {
      stage.check();
      if (neighbor != far_away() && !is_exact(neighbor) && !fits(neighbor, in_mesh, in_cell))
        misfits.push_back(neighbor);
    };
    for (const Index neighbor : in_mesh) check(neighbor);
    for (const Index neighbor : in_cell) check(neighbor);
  });
  std::vector<Index> result;
  for (const Worker& worker : workers) {
    for (const Index site : worker.misfits) {
      if (is_exact(site)) continue;
      exact_of_[site] = k_wanted;
      result.push_back(site);
    }
  }
  std::sort(result.begin(), result.end());
  return result;
}

/// Places the cells; where cells of the mesh are next to them, edges and vertices have the mesh's places.
void WeightedCells::place_exact_cells(const JobStage& stage) {
  vertex_place_count_ = in_mesh();
  edge_place_count_ = 4 * vertex_place_count_;
  std::vector<Index> sites(exact_.size());
  for (Index site = 0; site < sites_.count(); ++site)
    if (is_exact(site)) sites[exact_of_[site]] = site;
  parallel_for(static_cast<Index>(sites.size()), threads_, k_few, [&](Index i, int) {
    Exact& cell = exact_[i];
    cell.placed.reserve(cell.sides.size());
    for (const WeightedCell::Side& side : cell.sides) cell.placed.push_back({side.neighbor, k_none, k_none});
    if (mesh_) place_by_mesh(sites[i], cell, stage);
  });
  for (const Index site : sites) {
    for (Index side = 0; side < static_cast<Index>(exact_[exact_of_[site]].sides.size()); ++side) {
      stage.check();
      place_edge(site, side);
      place_vertex(site, side);
    }
  }
}

Index WeightedCells::before(const Exact& cell, Index side) {
  return side == 0 ? static_cast<Index>(cell.sides.size()) - 1 : side - 1;
}

void WeightedCells::place_by_mesh(Index site, Exact& cell, const JobStage& stage) const {
  mesh_->visit_ring(site, [&](Index neighbor, Index half) {
    stage.check();
    if (neighbor == far_away() || is_exact(neighbor)) return;
    const auto found = std::find_if(cell.sides.begin(), cell.sides.end(),
                                    [&](const WeightedCell::Side& side) { return side.neighbor == neighbor; });
    const Index side = static_cast<Index>(found - cell.sides.begin()), last = before(cell, side);
    const Index twin = mesh_->twin(half);
    cell.placed[side].edge = site < neighbor ? twin : half;
    if (!cell.sides[side].is_open) cell.placed[side].vertex = half / 4;
    if (!cell.sides[last].is_open) cell.placed[last].vertex = twin / 4;
  });
}

/// Returns the same edge from the other side: of several between the same cells the first here is the last there.
Index WeightedCells::twin_of(Index site, const WeightedCell::Side& side) const {
  if (!is_exact(side.neighbor)) fail();
  const std::vector<WeightedCell::Side>& others = exact_[exact_of_[side.neighbor]].sides;
  for (std::size_t i = 0; i < others.size(); ++i)
    if (others[i].neighbor == site && others[i].ordinals == side.ordinals &&
        others[i].ordinal + side.ordinal + 1 == side.ordinals)
      return static_cast<Index>(i);
  fail();
}

void WeightedCells::place_edge(Index site, Index side) {
  Exact& cell = exact_[exact_of_[site]];
  if (cell.placed[side].edge != k_none) return;
  const Index twin = twin_of(site, cell.sides[side]);
  Index& other = exact_[exact_of_[cell.sides[side].neighbor]].placed[twin].edge;
  if (other != k_none) fail();
  cell.placed[side].edge = other = edge_place_count_++;
}

/// Places the vertex by going from cell to cell about the vertex, counter-clockwise: the corner behind a side of one is
/// the one before that side in the next.
void WeightedCells::place_vertex(Index site, Index side) {
  if (exact_[exact_of_[site]].sides[side].is_open || exact_[exact_of_[site]].placed[side].vertex != k_none) return;
  Index walk = site, corner = side, lowest = far_away();
  Vec2 position(0, 0);
  do {
    Exact& cell = exact_[exact_of_[walk]];
    if (cell.sides[corner].is_open || cell.placed[corner].vertex != k_none) fail();
    cell.placed[corner].vertex = vertex_place_count_;
    if (walk < lowest) lowest = walk, position = cell.sides[corner].corner;
    const Index twin = twin_of(walk, cell.sides[corner]);
    walk = cell.sides[corner].neighbor;
    corner = before(exact_[exact_of_[walk]], twin);
  } while (walk != site || corner != side);
  ++vertex_place_count_;
  vertices_.push_back({position, lowest});
}

void WeightedCells::read(Index site, LargeArray<Side>& sides) const {
  if (is_exact(site)) {
    const std::vector<Side>& placed = exact_[exact_of_[site]].placed;
    sides.insert(sides.end(), placed.begin(), placed.end());
    return;
  }
  const auto begin = static_cast<std::ptrdiff_t>(sides.size());
  auto first = begin;
  Index last = mesh_->last_in_ring(site), lowest = far_away();
  mesh_->visit_ring(site, [&](Index neighbor, Index half) {
    const Index twin = previous_half(last);
    last = half;
    if (neighbor == far_away()) return;
    first = neighbor < lowest ? static_cast<std::ptrdiff_t>(sides.size()) : first;
    lowest = std::min(lowest, neighbor);
    sides.push_back({neighbor, site < neighbor ? twin : half, mesh_->is_far(half / 4) ? k_none : half / 4});
  });
  std::rotate(sides.begin() + begin, sides.begin() + first, sides.end());
}

Index WeightedCells::lowest_about(Index vertex) const {
  return vertex < in_mesh() ? mesh_->lowest_about(vertex) : vertices_[vertex - in_mesh()].lowest;
}

Vec2 WeightedCells::position(Index vertex) const {
  return vertex < in_mesh() ? mesh_->corner(vertex) : vertices_[vertex - in_mesh()].position;
}

}  // namespace saddleback::voronoi2d
