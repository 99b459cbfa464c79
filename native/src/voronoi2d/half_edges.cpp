#include "voronoi2d/half_edges.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>

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

// A side of a cell and whether it is the first in its cell's list, in one number.
struct Side {
  std::uint32_t code;
  Index index() const { return static_cast<Index>(code >> 1); }
  bool is_first() const { return code & 1; }
};

class Stitcher {
 public:
  Stitcher(const Cells& cells, const OrderedSites& sites, Numbering& result)
      : cells_(cells), sites_(sites), result_(result), twins_(cells.neighbours.size()) {}

  bool stitch(int threads, const JobStage& stage) {
    const Index count = cells_.cell_count(), side_count = static_cast<Index>(twins_.size());
    const Index edge_count = side_count / 2, vertex_count = cells_.are_strips ? 0 : edge_count - count + 1;
    // The pieces' boundaries do not show in the result.
    const Index piece_count = thread_count(threads) == 1 ? 1 : std::clamp<Index>(count / 8192, 1, 256);
    std::vector<Piece> pieces(piece_count + 1);
    for (Index i = 0; i <= piece_count; ++i)
      pieces[i].begin = static_cast<Index>(static_cast<std::int64_t>(count) * i / piece_count);

    std::atomic<bool> fits{side_count % 2 == 0 && vertex_count >= 0};
    parallel_for(piece_count, threads, 1, [&](Index i, int) {
      stage.check();
      if (!find_twins(pieces[i].begin, pieces[i + 1].begin)) fits = false;
    });
    if (!fits) return false;
    result_.corner_vertices.assign(side_count, k_none);
    result_.side_edges.resize(side_count);
    stage.update(0.3);
    if (piece_count > 1) {
      parallel_for(piece_count, threads, 1, [&](Index i, int) { count_own(pieces[i], pieces[i + 1].begin); });
    } else {
      pieces[0].vertices = vertex_count;
      pieces[0].edges = edge_count;
    }
    for (Index i = 0, vertices = 0, edges = 0; i <= piece_count; ++i) {
      std::swap(pieces[i].vertices, vertices);
      std::swap(pieces[i].edges, edges);
      vertices += pieces[i].vertices;
      edges += pieces[i].edges;
    }
    if (pieces.back().vertices != vertex_count || pieces.back().edges != edge_count) return false;
    stage.update(0.5);
    result_.vertices.resize(vertex_count);
    result_.edge_vertices.resize(edge_count);
    result_.edge_sites.resize(edge_count);
    parallel_for(piece_count, threads, 1, [&](Index i, int) {
      stage.check();
      if (!add_vertices(pieces[i], pieces[i + 1])) fits = false;
    });
    if (!fits) return false;
    stage.update(0.8);
    parallel_for(piece_count, threads, 1, [&](Index i, int) {
      stage.check();
      add_edges(pieces[i], pieces[i + 1].begin);
    });
    stage.update(1);
    return true;
  }

 private:
  struct Piece {
    Index begin = 0;                ///< cell
    Index vertices = 0, edges = 0;  ///< how many are its own, then how many come before
  };

  // An edge belongs to the lower rank, which finds both of its sides.
  bool find_twins(Index begin, Index end) {
    for (Index cell = begin; cell < end; ++cell) {
      const Index first = cells_.offsets[cell];
      if (!cells_.are_strips && !winds_once(cell)) return false;
      for (Index side = first; side < cells_.offsets[cell + 1]; ++side) {
        const Index other = cells_.neighbours[side];
        const Index other_first = cells_.offsets[other], other_end = cells_.offsets[other + 1];
        if (other < cell) continue;
        Index twin = other_first;
        while (twin < other_end && cells_.neighbours[twin] != cell) ++twin;
        if (twin == other_end) return false;
        twins_[side] = {2 * static_cast<std::uint32_t>(twin) + (twin == other_first)};
        twins_[twin] = {2 * static_cast<std::uint32_t>(side) + (side == first)};
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
    bool before = is_above(cells_.neighbours[cells_.is_open[cell] ? first : last]);
    int crossings = 0;
    for (Index side = first; side <= last; ++side) {
      const bool now = is_above(cells_.neighbours[side]);
      crossings += now != before;
      before = now;
    }
    if (!cells_.is_open[cell]) return crossings == 2;
    return crossings <= 1 && predicates::orient_2d(point(cells_.neighbours[last]), point(cell),
                                                   point(cells_.neighbours[first])) != predicates::Sign::negative;
  }

  // The next corner about the same vertex, counter-clockwise: that of the cell across the corner's side.
  Index next_corner(Index corner) const {
    const Side twin = twins_[corner];
    if (!twin.is_first()) return twin.index() - 1;
    return cells_.offsets[cells_.neighbours[corner] + 1] - 1;
  }

  // Calls found(corner) for the corners of the vertices that belong to the cells: no lower rank is about them.
  template <class Found>
  void for_own_vertices(Index begin, Index end, Found&& found) const {
    if (cells_.are_strips) return;
    for (Index cell = begin; cell < end; ++cell) {
      const Index first = cells_.offsets[cell], last = cells_.offsets[cell + 1] - 1;
      for (Index corner = first; corner <= last - cells_.is_open[cell]; ++corner) {
        if (cells_.neighbours[corner] < cell) continue;
        if (cells_.neighbours[corner == last ? first : corner + 1] < cell) continue;
        Index lowest = cell;
        for (Index walk = next_corner(corner); walk != corner; walk = next_corner(walk))
          lowest = std::min(lowest, cells_.neighbours[walk]);
        if (lowest == cell) found(cell, corner);
      }
    }
  }

  void count_own(Piece& piece, Index end) const {
    for_own_vertices(piece.begin, end, [&](Index, Index) { ++piece.vertices; });
    for (Index cell = piece.begin; cell < end; ++cell)
      for (Index side = cells_.offsets[cell]; side < cells_.offsets[cell + 1]; ++side)
        piece.edges += cells_.neighbours[side] > cell;
  }

  predicates::Point2 point(Index rank) const { return {sites_.x[rank], sites_.y[rank]}; }

  // False when there are not as many as there should be.
  bool add_vertices(const Piece& piece, const Piece& next) {
    Index vertex = piece.vertices;
    bool fits = true;
    for_own_vertices(piece.begin, next.begin, [&](Index cell, Index corner) {
      fits = fits && vertex < next.vertices;
      if (!fits) return;
      // Three sites evenly about the vertex, so that their circle is well determined.
      Index walk = corner, size = 0;
      do {
        result_.corner_vertices[walk] = vertex;
        walk = next_corner(walk);
        ++size;
      } while (walk != corner);
      std::array<Index, 3> about{cell, cells_.neighbours[corner], cells_.neighbours[next_corner(corner)]};
      if (size > 3) {
        for (Index k = 1, step = 0; k < 3; ++k) {
          for (; step + 1 < k * size / 3; ++step) walk = next_corner(walk);
          about[k] = cells_.neighbours[walk];
        }
      }
      result_.vertices[vertex++] = circumcentre(point(about[0]), point(about[1]), point(about[2])) / sites_.scale;
    });
    return fits && vertex == next.vertices;
  }

  void add_edges(const Piece& piece, Index end) {
    Index edge = piece.edges;
    for (Index cell = piece.begin; cell < end; ++cell) {
      const Index first = cells_.offsets[cell], last = cells_.offsets[cell + 1] - 1;
      for (Index side = first; side <= last; ++side) {
        const Index other = cells_.neighbours[side];
        if (other < cell) continue;
        result_.side_edges[side] = result_.side_edges[twins_[side].index()] = edge;
        std::array<Index, 2> ends{result_.corner_vertices[side == first ? last : side - 1],
                                  result_.corner_vertices[side]};
        std::array<Index, 2> pair{sites_.original[cell], sites_.original[other]};
        if (ends[0] == k_none) {
          std::swap(ends[0], ends[1]);
          std::swap(pair[0], pair[1]);
        }
        result_.edge_vertices[edge] = ends;
        result_.edge_sites[edge] = pair;
        ++edge;
      }
    }
  }

  const Cells& cells_;
  const OrderedSites& sites_;
  Numbering& result_;
  LargeArray<Side> twins_;
};

}  // namespace

bool number(const Cells& cells, const OrderedSites& sites, int threads, const JobStage& stage, Numbering& result) {
  return Stitcher(cells, sites, result).stitch(threads, stage);
}

}  // namespace saddleback::voronoi2d
