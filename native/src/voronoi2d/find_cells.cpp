// Tiles are squares of the space-filling curve with not too many sites. Each has a circle of its own, which also sees
// the sites within a margin about the tile and stops when the tile's cells are closed. A cell is in doubt when it is
// open, or when a circle about one of its vertices leaves the margin: the cells in doubt, few except where the sites
// have an outline, are found again by one circle among themselves, their neighbours and theirs.

#include "voronoi2d/find_cells.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

#include "support/parallel.h"
#include "voronoi2d/circumcentre.h"
#include "voronoi2d/sweep_circle.h"

namespace saddleback::voronoi2d {
namespace {

struct Box {
  double low[2] = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  double high[2] = {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};

  void add(double x, double y) {
    low[0] = std::min(low[0], x), low[1] = std::min(low[1], y);
    high[0] = std::max(high[0], x), high[1] = std::max(high[1], y);
  }
  void add(const Box& other) {
    for (int k = 0; k < 2; ++k) low[k] = std::min(low[k], other.low[k]), high[k] = std::max(high[k], other.high[k]);
  }
  bool contains(double x, double y) const { return x >= low[0] && x <= high[0] && y >= low[1] && y <= high[1]; }
  bool meets(const Box& other) const {
    return low[0] <= other.high[0] && high[0] >= other.low[0] && low[1] <= other.high[1] && high[1] >= other.low[1];
  }
  Vec2 centre() const { return {0.5 * low[0] + 0.5 * high[0], 0.5 * low[1] + 0.5 * high[1]}; }
};

Box box_of(const OrderedSites& sites, Index begin, Index end) {
  Box box;
  for (Index i = begin; i < end; ++i) box.add(sites.x[i], sites.y[i]);
  return box;
}

/// Cells of some sites, one after another.
struct CellLists {
  LargeArray<Index> neighbours, sizes;
  LargeArray<std::uint8_t> is_open, is_doubtful;

  void reserve(Index count) {
    neighbours.reserve(static_cast<std::size_t>(6) * count + count / 8);
    sizes.reserve(count);
    is_open.reserve(count);
    is_doubtful.reserve(count);
  }
};

// Turns a ring of ranks until the lowest is the first.
void lowest_first(std::span<Index> ring) {
  constexpr std::size_t k_few = 16;
  std::size_t lowest = 0;
  for (std::size_t i = 1; i < ring.size(); ++i) lowest = ring[i] < ring[lowest] ? i : lowest;
  if (ring.size() > k_few) {
    std::rotate(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(lowest), ring.end());
    return;
  }
  std::array<Index, 2 * k_few> twice;
  for (std::size_t i = 0; i < ring.size(); ++i) twice[i] = twice[i + ring.size()] = ring[i];
  for (std::size_t i = 0; i < ring.size(); ++i) ring[i] = twice[lowest + i];
}

/// Reads cells off the mesh of a circle.
class CellReader {
 public:
  /// `rank_of` tells the ranks of the sites by their position in the arrays that the circle was given.
  template <class RankOf>
  void open(const PlanarMesh& mesh, const SweepCircle& circle, RankOf&& rank_of) {
    mesh_ = mesh;
    is_flat_ = circle.is_flat.data();
    ranks_.resize(mesh.site_count);
    places_.resize(mesh.site_count);
    for (Index k = 0; k < mesh.site_count; ++k) {
      const Index position = circle.position(k);
      places_[position] = k;
      ranks_[k] = rank_of(position);
    }
    leaving_.assign(mesh.site_count, k_none);
    for (Index first = 0; first < mesh.half_end(); first += 4)
      for (Index half = first; half < first + 3; ++half) leaving_[mesh.triangles[half]] = half;
    for (Index first = 0; first < mesh.half_end(); first += 4)  // from the border counter-clockwise
      for (Index half = first; half < first + 3; ++half)
        if (mesh.twins[half] == k_none) leaving_[mesh.triangles[half]] = half;
  }

  /// Appends the cell of the site at a position. An edge between triangles on one circle is no neighbour.
  void read(Index position, CellLists& out) const {
    const std::size_t begin = out.neighbours.size();
    const Index first = leaving_[places_[position]];
    bool is_open = first == k_none || mesh_.twins[first] == k_none;
    for (Index half = first; half != k_none;) {
      if (!is_flat_[half]) out.neighbours.push_back(ranks_[mesh_.triangles[next_half(half)]]);
      const Index last = previous_half(half);
      half = mesh_.twins[last];
      if (half == first) break;
      if (half == k_none) out.neighbours.push_back(ranks_[mesh_.triangles[last]]);
    }
    if (!is_open) lowest_first(std::span(out.neighbours).subspan(begin));
    out.sizes.push_back(static_cast<Index>(out.neighbours.size() - begin));
    out.is_open.push_back(is_open);
  }

 private:
  PlanarMesh mesh_{};
  const std::uint8_t* is_flat_ = nullptr;
  std::vector<Index> ranks_, places_, leaving_;
};

/// Boxes about every 32 sites in the order, and about every 32 of those.
class BoxTree {
 public:
  explicit BoxTree(const OrderedSites& sites) : sites_(sites) {
    const Index count = sites.count();
    fine_.resize((count + k_fan - 1) / k_fan);
    coarse_.resize((fine_.size() + k_fan - 1) / k_fan);
    for (std::size_t i = 0; i < fine_.size(); ++i) {
      const Index begin = static_cast<Index>(i) * k_fan;
      fine_[i] = box_of(sites, begin, std::min(count, begin + k_fan));
      coarse_[i / k_fan].add(fine_[i]);
    }
  }

  /// Calls found(rank) for the sites in a box that are not in [begin, end).
  template <class Found>
  void for_each_in(const Box& box, Index begin, Index end, Found&& found) const {
    const Index fine_count = static_cast<Index>(fine_.size()), count = sites_.count();
    for (Index i = 0; i < static_cast<Index>(coarse_.size()); ++i) {
      if (!coarse_[i].meets(box)) continue;
      for (Index j = i * k_fan; j < std::min(fine_count, (i + 1) * k_fan); ++j) {
        if (!fine_[j].meets(box) || (j * k_fan >= begin && (j + 1) * k_fan <= end)) continue;
        for (Index rank = j * k_fan; rank < std::min(count, (j + 1) * k_fan); ++rank)
          if ((rank < begin || rank >= end) && box.contains(sites_.x[rank], sites_.y[rank])) found(rank);
      }
    }
  }

 private:
  static constexpr Index k_fan = 32;
  const OrderedSites& sites_;
  std::vector<Box> fine_, coarse_;
};

/// Ranges of ranks: squares of the curve, split until they are small enough, neighbours joined while they are.
class Tiling {
 public:
  Tiling(const OrderedSites& sites, Index size) : places_(sites.places), size_(size) {
    ends_.push_back(0);
    split(0, sites.count(), 32);
  }
  Index count() const { return static_cast<Index>(ends_.size()) - 1; }
  Index begin(Index tile) const { return ends_[tile]; }
  Index end(Index tile) const { return ends_[tile + 1]; }

 private:
  void split(Index begin, Index end, int bits) {
    if (end - begin <= size_) {
      add(end);
    } else if (bits == 0) {  // in one square of the finest curve
      const Index middle = begin + (end - begin) / 2;
      split(begin, middle, 0);
      split(middle, end, 0);
    } else {
      for (std::uint32_t quarter = 0; quarter < 4; ++quarter) {
        const auto in_quarter = [&](std::uint32_t place) { return ((place >> (bits - 2)) & 3) <= quarter; };
        const auto last = std::partition_point(places_.begin() + begin, places_.begin() + end, in_quarter);
        const Index middle = static_cast<Index>(last - places_.begin());
        if (middle > begin) split(begin, middle, bits - 2);
        begin = middle;
      }
    }
  }
  void add(Index end) {
    const std::size_t n = ends_.size();
    if (n >= 2 && end - ends_[n - 2] <= size_) ends_.pop_back();  // one tile with the one before
    ends_.push_back(end);
  }

  const LargeArray<std::uint32_t>& places_;
  Index size_;
  std::vector<Index> ends_;
};

/// A worker's memory.
struct Worker {
  SweepCircle circle;
  CellReader reader;
  std::vector<Index> ranks;
  std::vector<double> x, y;
  std::vector<std::uint8_t> leaves_margin;
};

// Whether the circle through three sites stays in a box, up to rounding. Most do by far: then without a division.
bool stays_in(const Box& box, const predicates::Point2& a, const predicates::Point2& b, const predicates::Point2& c) {
  const auto reach_of = [&](double x, double y) {
    return std::min(std::min(x - box.low[0], box.high[0] - x), std::min(y - box.low[1], box.high[1] - y));
  };
  const double bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y, det = bx * cy - by * cx;
  const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy, bc2 = (bx - cx) * (bx - cx) + (by - cy) * (by - cy);
  const double reach = reach_of(a.x, a.y);
  if (b2 * c2 * bc2 <= det * det * reach * reach) return true;  // a diameter fits between a and the box
  const Vec2 v = circumcentre(a, b, c);
  const double reach_of_centre = reach_of(v.x(), v.y()), dx = v.x() - a.x, dy = v.y() - a.y;
  return reach_of_centre > 0 && dx * dx + dy * dy < reach_of_centre * reach_of_centre;
}

// Marks the positions of sites with a vertex whose circle leaves a box.
void mark_leaving(const PlanarMesh& mesh, const Box& box, const SweepCircle& circle, std::vector<std::uint8_t>& marks) {
  for (Index first = 0; first < mesh.half_end(); first += 4) {
    const Index* const corners = mesh.triangles + first;
    if (stays_in(box, mesh.point(corners[0]), mesh.point(corners[1]), mesh.point(corners[2]))) continue;
    for (Index k = 0; k < 3; ++k) marks[circle.position(corners[k])] = 1;
  }
}

void find_tile(const OrderedSites& sites, const BoxTree& tree, Index begin, Index end, Worker& w, CellLists& out,
               const JobStage& stage) {
  const Index own_count = end - begin;
  Box box = box_of(sites, begin, end);
  const double width = box.high[0] - box.low[0], height = box.high[1] - box.low[1];
  constexpr double k_margin = 3;  // in mean distances; larger circles are found by doubt
  const double margin = k_margin * std::sqrt(width / own_count * height);
  Box margin_box = box;
  for (int k = 0; k < 2; ++k) margin_box.low[k] -= margin, margin_box.high[k] += margin;
  w.ranks.resize(own_count);
  std::iota(w.ranks.begin(), w.ranks.end(), begin);
  tree.for_each_in(margin_box, begin, end, [&](Index rank) { w.ranks.push_back(rank); });
  w.x.resize(w.ranks.size());
  w.y.resize(w.ranks.size());
  for (std::size_t i = 0; i < w.ranks.size(); ++i) w.x[i] = sites.x[w.ranks[i]], w.y[i] = sites.y[w.ranks[i]];

  PlanarMesh mesh = w.circle.sweep(w.x, w.y, own_count, box.centre(), {});
  w.circle.is_flat.resize(mesh.half_end());
  if (!passes_circle_tests(mesh, w.circle.is_flat)) mesh = w.circle.triangulate(w.x, w.y, box.centre(), stage);
  w.leaves_margin.assign(w.ranks.size(), 0);
  mark_leaving(mesh, margin_box, w.circle, w.leaves_margin);
  w.reader.open(mesh, w.circle, [&](Index position) { return w.ranks[position]; });
  out.reserve(own_count);
  for (Index i = 0; i < own_count; ++i) {
    w.reader.read(i, out);
    out.is_doubtful.push_back(out.is_open.back() | w.leaves_margin[i]);
  }
}

// One after another, in the order of the ranks.
Cells joined(std::vector<CellLists>& tiles, Index count, int threads, const JobStage& stage) {
  Cells cells;
  cells.offsets.reserve(count + 1);
  cells.offsets.push_back(0);
  cells.is_open.reserve(count);
  for (const CellLists& tile : tiles) {
    for (const Index size : tile.sizes) cells.offsets.push_back(cells.offsets.back() + size);
    cells.is_open.insert(cells.is_open.end(), tile.is_open.begin(), tile.is_open.end());
  }
  cells.neighbours.resize(cells.offsets.back());
  std::vector<Index> first{0};
  for (const CellLists& tile : tiles) first.push_back(first.back() + static_cast<Index>(tile.sizes.size()));
  parallel_for(static_cast<Index>(tiles.size()), threads, 1, [&](Index i, int) {
    stage.check();
    std::copy(tiles[i].neighbours.begin(), tiles[i].neighbours.end(),
              cells.neighbours.begin() + cells.offsets[first[i]]);
    LargeArray<Index>().swap(tiles[i].neighbours);
  });
  return cells;
}

// Adds the neighbours of the ranks from `begin` on.
void add_neighbours(const Cells& cells, std::vector<Index>& ranks, std::size_t begin, std::vector<bool>& is_in) {
  for (std::size_t end = ranks.size(); begin < end; ++begin) {
    for (Index side = cells.offsets[ranks[begin]]; side < cells.offsets[ranks[begin] + 1]; ++side) {
      const Index other = cells.neighbours[side];
      if (is_in[other]) continue;
      is_in[other] = true;
      ranks.push_back(other);
    }
  }
}

// Finds the cells of some ranks (ascending) again, among these, their neighbours and the neighbours of those.
Cells renew_cells(const OrderedSites& sites, const Cells& cells, std::vector<Index> ranks, const JobStage& stage) {
  const std::size_t own_count = ranks.size();
  std::vector<bool> is_in(sites.count(), false);
  for (const Index rank : ranks) is_in[rank] = true;
  add_neighbours(cells, ranks, 0, is_in);
  add_neighbours(cells, ranks, own_count, is_in);
  std::vector<double> x, y;
  for (const Index rank : ranks) x.push_back(sites.x[rank]), y.push_back(sites.y[rank]);
  SweepCircle circle;
  const PlanarMesh mesh = circle.triangulate(x, y, box_of(sites, 0, sites.count()).centre(), stage);
  CellReader reader;
  reader.open(mesh, circle, [&](Index position) { return ranks[position]; });
  CellLists lists;
  for (std::size_t i = 0; i < own_count; ++i) reader.read(static_cast<Index>(i), lists);

  Cells result;
  result.offsets.reserve(cells.offsets.size());
  result.offsets.push_back(0);
  result.neighbours.reserve(cells.neighbours.size() + lists.neighbours.size());
  result.is_open = cells.is_open;
  auto list = lists.neighbours.begin();
  Index kept = 0;  // cells before the next renewed one go over as they are
  for (std::size_t i = 0; i <= own_count; ++i) {
    if (i % 1024 == 0) stage.check();
    const Index rank = i < own_count ? ranks[i] : sites.count();
    const Index shift = static_cast<Index>(result.neighbours.size()) - cells.offsets[kept];
    result.neighbours.insert(result.neighbours.end(), cells.neighbours.begin() + cells.offsets[kept],
                             cells.neighbours.begin() + cells.offsets[rank]);
    for (; kept < rank; ++kept) result.offsets.push_back(cells.offsets[kept + 1] + shift);
    if (i == own_count) break;
    result.neighbours.insert(result.neighbours.end(), list, list + lists.sizes[i]);
    list += lists.sizes[i];
    result.offsets.push_back(static_cast<Index>(result.neighbours.size()));
    result.is_open[rank] = lists.is_open[i];
    kept = rank + 1;
  }
  return result;
}

// Ranks, ascending, of the cells on both sides where one has the other for its neighbour but not the other way round,
// if one of them is among some.
std::vector<Index> misfits(const Cells& cells, std::span<const Index> among) {
  std::vector<bool> is_among(cells.cell_count(), false);
  for (const Index cell : among) is_among[cell] = true;
  std::vector<Index> result;
  for (Index cell = 0; cell < cells.cell_count(); ++cell) {
    for (Index side = cells.offsets[cell]; side < cells.offsets[cell + 1]; ++side) {
      const Index other = cells.neighbours[side];
      if (!is_among[other] && !is_among[cell]) continue;
      const auto begin = cells.neighbours.begin() + cells.offsets[other],
                 end = cells.neighbours.begin() + cells.offsets[other + 1];
      if (std::find(begin, end, cell) == end) result.insert(result.end(), {cell, other});
    }
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

}  // namespace

Cells find_cells(const OrderedSites& sites, const JobStage& stage) {
  const Index count = sites.count();
  SweepCircle circle;
  PlanarMesh mesh{};
  if (count > 2) mesh = circle.triangulate(sites.x, sites.y, box_of(sites, 0, count).centre(), stage);
  if (mesh.triangle_count == 0) return strips_of(sites);
  CellReader reader;
  reader.open(mesh, circle, [](Index position) { return position; });
  CellLists lists;
  lists.reserve(count);
  for (Index i = 0; i < count; ++i) {
    if (i % 65536 == 0) stage.check();
    reader.read(i, lists);
  }
  Cells cells;
  cells.offsets.resize(count + 1);
  cells.offsets[0] = 0;
  std::partial_sum(lists.sizes.begin(), lists.sizes.end(), cells.offsets.begin() + 1);
  cells.neighbours = std::move(lists.neighbours);
  cells.is_open = std::move(lists.is_open);
  return cells;
}

Cells find_cells_by_tiles(const OrderedSites& sites, Index circle_size, int threads, const JobStage& stage) {
  const Tiling tiling(sites, circle_size);
  const BoxTree tree(sites);
  std::vector<CellLists> tiles(tiling.count());
  std::vector<Worker> workers(std::min(thread_count(threads), tiling.count()));
  std::atomic<Index> done{0}, doubtful{0};
  parallel_for(tiling.count(), threads, 1, [&](Index i, int thread) {
    const Index begin = tiling.begin(i), end = tiling.end(i), seen = done;
    if (seen > 8 * circle_size && 2 * doubtful > seen) return;
    find_tile(sites, tree, begin, end, workers[thread], tiles[i], stage);
    doubtful += static_cast<Index>(std::count(tiles[i].is_doubtful.begin(), tiles[i].is_doubtful.end(), 1));
    done += end - begin;
    stage.update(0.9 * static_cast<double>(done) / sites.count());
  });
  if (2 * doubtful > done) return {};
  std::vector<Index> ranks;
  for (Index i = 0; i < tiling.count(); ++i)
    for (Index k = 0; k < tiling.end(i) - tiling.begin(i); ++k)
      if (tiles[i].is_doubtful[k]) ranks.push_back(tiling.begin(i) + k);
  stage.check();
  Cells cells = joined(tiles, sites.count(), threads, stage);
  // A cell may lack a neighbour that was not among the sites it was found from, but knows it: then both once more.
  constexpr int k_attempts = 8;
  for (int attempt = 0; attempt < k_attempts && !ranks.empty(); ++attempt) {
    if (static_cast<Index>(ranks.size()) > sites.count() / 2) return {};
    stage.check();
    cells = renew_cells(sites, cells, ranks, stage.part(0.9, 0.9));
    ranks = misfits(cells, ranks);
  }
  return cells;
}

}  // namespace saddleback::voronoi2d
