#include "voronoi2d/half_edges.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <numeric>
#include <utility>

#include "support/parallel.h"
#include "voronoi2d/circumcentre.h"

namespace saddleback::voronoi2d {
Cells strips_of(const OrderedSites& sites) {
  const Index count = sites.count();
  std::vector<Index> along(count), place(count);
  std::iota(along.begin(), along.end(), 0);
  std::sort(along.begin(), along.end(), [&](Index a, Index b) {
    return sites.x[a] != sites.x[b] ? sites.x[a] < sites.x[b] : sites.y[a] < sites.y[b];
  });
  for (Index i = 0; i < count; ++i) place[along[i]] = i;
  Cells cells;
  cells.are_strips = true;
  cells.is_open.assign(count, 1);
  cells.offsets.push_back(0);
  for (Index site = 0; site < count; ++site) {
    const Index i = place[site];
    if (i > 0) cells.neighbours.push_back(along[i - 1]);
    if (i + 1 < count) cells.neighbours.push_back(along[i + 1]);
    cells.offsets.push_back(static_cast<Index>(cells.neighbours.size()));
  }
  return cells;
}

namespace {

class Stitcher {
 public:
  Stitcher(const Cells& cells, const OrderedSites& sites, Numbering& result)
      : cells_(cells), sites_(sites), result_(result), next_corners_(cells.neighbours.size()) {}

  bool stitch(int threads, const JobStage& stage) {
    const Index count = cells_.cell_count(), side_count = static_cast<Index>(next_corners_.size());
    const Index edge_count = side_count / 2;
    vertex_count_ = cells_.are_strips ? 0 : edge_count - count + 1;
    if (side_count % 2 != 0 || vertex_count_ < 0) return false;
    result_.corner_vertices.resize(side_count);
    result_.side_edges.resize(side_count);
    result_.vertices.resize(vertex_count_);
    result_.edge_vertices.resize(edge_count);
    result_.edge_sites.resize(edge_count);

    // Boundaries of pieces do not show in the result.
    const Index piece_count =
        thread_count(threads) == 1 ? std::clamp<Index>(count / 65536, 1, 256) : std::clamp<Index>(count / 8192, 1, 256);
    pieces_.assign(piece_count + 1, {});
    for (Index i = 0; i <= piece_count; ++i)
      pieces_[i].begin = static_cast<Index>(static_cast<std::int64_t>(count) * i / piece_count);
    const bool in_order = thread_count(threads) == 1;  // then the numbers follow without being counted before
    const auto for_pieces = [&](double done, auto&& work) {
      std::atomic<bool> fits{true};
      parallel_for(piece_count, threads, 1, [&](Index i, int) {
        stage.check();
        if (fits && !work(pieces_[i], pieces_[i + 1])) fits = false;
      });
      stage.update(done);
      return fits.load();
    };
    if (!in_order) {
      for_pieces(0.05, [&](Piece& piece, const Piece& next) { return count_edges(piece, next); });
      add_up(&Piece::edges);
      if (pieces_.back().edges != edge_count) return false;
    }
    Index edge = 0;
    const bool are_joined = for_pieces(0.4, [&](Piece& piece, const Piece& next) {
      if (in_order) piece.edges = edge;
      Index mine = piece.edges;
      const bool fits = join_sides(piece, next, mine);
      if (in_order) edge = mine;
      return fits;
    });
    if (!are_joined || (in_order && edge != edge_count)) return false;
    pieces_.back().edges = edge_count;
    if (!in_order) {
      for_pieces(0.55, [&](Piece& piece, const Piece& next) { return count_vertices(piece, next); });
      add_up(&Piece::vertices);
      if (pieces_.back().vertices != vertex_count_) return false;
    }
    Index vertex = 0;
    const bool are_placed = for_pieces(0.85, [&](Piece& piece, const Piece& next) {
      Index mine = piece.vertices;
      return add_vertices(piece, next, in_order ? vertex : mine);
    });
    if (!are_placed || (in_order && vertex != vertex_count_)) return false;
    return for_pieces(1, [&](Piece& piece, const Piece& next) { return add_ends(piece, next); });
  }

 private:
  struct Piece {
    Index begin = 0;                ///< cell
    Index vertices = 0, edges = 0;  ///< how many are its own, then how many come before
  };

  void add_up(Index Piece::*member) {
    Index before = 0;
    for (Piece& piece : pieces_) before += std::exchange(piece.*member, before);
  }

  bool count_edges(Piece& piece, const Piece& next) const {
    for (Index cell = piece.begin; cell < next.begin; ++cell)
      for (Index side = cells_.offsets[cell]; side < cells_.offsets[cell + 1]; ++side)
        piece.edges += cells_.neighbours[side] > cell;
    return true;
  }

  // Where a cell stands in the list of another; beyond its end when it does not.
  Index find(Index cell, Index begin, Index end) const {
    constexpr Index k_most = 8;
    const Index* const list = cells_.neighbours.data() + begin;
    if (begin + k_most <= static_cast<Index>(cells_.neighbours.size())) {  // without branches
      unsigned found = 0;
      for (Index k = 0; k < k_most; ++k) found |= static_cast<unsigned>(list[k] == cell) << k;
      if (found != 0) return begin + std::countr_zero(found);
    }
    return static_cast<Index>(std::find(list, list + (end - begin), cell) - list) + begin;
  }

  // Numbers the edges, which belong to the lower rank, from `edge` on, and moves that. Of each side finds the next
  // corner, counter-clockwise, about the vertex behind it: that of the cell across the side.
  bool join_sides(const Piece& piece, const Piece& next, Index& edge) {
    const Index edge_count = static_cast<Index>(result_.edge_sites.size());
    for (Index cell = piece.begin; cell < next.begin; ++cell) {
      const Index first = cells_.offsets[cell], end = cells_.offsets[cell + 1];
      if (!cells_.are_strips && !winds_once(cell)) return false;
      for (Index side = first; side < end; ++side) {
        const Index other = cells_.neighbours[side];
        if (other < cell) continue;
        const Index other_first = cells_.offsets[other], other_end = cells_.offsets[other + 1];
        const Index twin = find(cell, other_first, other_end);
        if (twin >= other_end || edge == edge_count) return false;
        next_corners_[side] = twin == other_first ? other_end - 1 : twin - 1;
        const Index before = side == first ? end - 1 : side - 1;
        next_corners_[twin] = before;
        result_.edge_vertices[edge] = {before, side};  // the corners for now
        result_.side_edges[side] = result_.side_edges[twin] = edge;
        result_.edge_sites[edge] = {sites_.original[cell], sites_.original[other]};
        ++edge;
      }
      if (cells_.are_strips) {
        std::fill(result_.corner_vertices.begin() + first, result_.corner_vertices.begin() + end, k_none);
      } else if (cells_.is_open[cell]) {
        result_.corner_vertices[end - 1] = k_none;
      }
    }
    return true;
  }

  // Neighbours of a closed cell turn once around it, those of an open one at most half a turn (exact). Turning crosses
  // the level line through the site whenever a neighbour is below it and the next is not.
  bool winds_once(Index cell) const {
    const Index first = cells_.offsets[cell], last = cells_.offsets[cell + 1] - 1;
    if (last <= first) return false;
    const double x = sites_.x[cell], y = sites_.y[cell];
    const auto is_above = [&](Index rank) {
      return (sites_.y[rank] > y) | ((sites_.y[rank] == y) & (sites_.x[rank] > x));
    };
    int before = is_above(cells_.neighbours[cells_.is_open[cell] ? first : last]), crossings = 0;
    for (Index side = first; side <= last; ++side) {
      const int now = is_above(cells_.neighbours[side]);
      crossings += now ^ before;
      before = now;
    }
    if (!cells_.is_open[cell]) return crossings == 2;
    return crossings <= 1 && predicates::orient_2d(point(cells_.neighbours[last]), point(cell),
                                                   point(cells_.neighbours[first])) != predicates::Sign::negative;
  }

  // Calls found(cell, corner) for the corners of the vertices that belong to the cells: no lower rank is about them.
  template <class Found>
  void for_own_vertices(Index begin, Index end, Found&& found) const {
    if (cells_.are_strips) return;
    for (Index cell = begin; cell < end; ++cell) {
      const Index first = cells_.offsets[cell], last = cells_.offsets[cell + 1] - 1;
      for (Index corner = first; corner <= last - cells_.is_open[cell]; ++corner) {
        const Index other = cells_.neighbours[corner], third = cells_.neighbours[corner == last ? first : corner + 1];
        if (std::min(other, third) < cell) continue;
        Index lowest = cell;
        for (Index walk = next_corners_[corner]; walk != corner; walk = next_corners_[walk])
          lowest = std::min(lowest, cells_.neighbours[walk]);
        if (lowest == cell) found(cell, corner);
      }
    }
  }

  bool count_vertices(Piece& piece, const Piece& next) const {
    for_own_vertices(piece.begin, next.begin, [&](Index, Index) { ++piece.vertices; });
    return true;
  }

  predicates::Point2 point(Index rank) const { return {sites_.x[rank], sites_.y[rank]}; }

  // Numbers vertices from `vertex` on, and moves that. False when there are more than there should be.
  bool add_vertices(const Piece& piece, const Piece& next, Index& vertex) {
    bool fits = true;
    for_own_vertices(piece.begin, next.begin, [&](Index cell, Index corner) {
      fits = fits && vertex < vertex_count_;
      if (!fits) return;
      const Index second = next_corners_[corner], third = next_corners_[second];
      std::array<Index, 3> about{cell, cells_.neighbours[corner], cells_.neighbours[second]};
      result_.corner_vertices[corner] = result_.corner_vertices[second] = result_.corner_vertices[third] = vertex;
      if (next_corners_[third] != corner) about = add_large_vertex(corner, vertex);
      result_.vertices[vertex++] = circumcentre(point(about[0]), point(about[1]), point(about[2])) / sites_.scale;
    });
    return fits;
  }

  // A vertex of more than three cells; returns three of them evenly about it, so that their circle is well determined.
  std::array<Index, 3> add_large_vertex(Index corner, Index vertex) {
    std::vector<Index> around;
    Index walk = corner;
    do {
      result_.corner_vertices[walk] = vertex;
      around.push_back(cells_.neighbours[walk]);
      walk = next_corners_[walk];
    } while (walk != corner);
    const std::size_t size = around.size();  // the last one is the cell that owns the corner
    return {around[size - 1], around[size / 3 - 1], around[2 * size / 3 - 1]};
  }

  // From the corners at the ends of the edges to their vertices.
  bool add_ends(const Piece& piece, const Piece& next) {
    for (Index edge = piece.edges; edge < next.edges; ++edge) {
      std::array<Index, 2>& ends = result_.edge_vertices[edge];
      for (Index& end : ends) end = result_.corner_vertices[end];
      if (ends[0] == k_none) {
        std::swap(ends[0], ends[1]);
        std::swap(result_.edge_sites[edge][0], result_.edge_sites[edge][1]);
      }
    }
    return true;
  }

  const Cells& cells_;
  const OrderedSites& sites_;
  Numbering& result_;
  LargeArray<Index> next_corners_;
  std::vector<Piece> pieces_;
  Index vertex_count_ = 0;
};

}  // namespace

bool number(const Cells& cells, const OrderedSites& sites, int threads, const JobStage& stage, Numbering& result) {
  return Stitcher(cells, sites, result).stitch(threads, stage);
}

}  // namespace saddleback::voronoi2d
