// Block by block of cells, in the order of their ranks: a site's triangles in turn are its corners, the half-edges that
// leave it its sides. A number is given at the lowest site about a vertex or beside an edge and left in the
// triangulation for the others: a vertex's beside the corners of its triangles, an edge's in place of a twin that is
// not needed any more. The edges' ends and sites are listed at last, from the cells, in the room of the triangles.

#include "voronoi2d/diagram/half_edges.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "support/threads/parallel.h"
#include "voronoi2d/diagram/cell_block.h"
#include "voronoi2d/diagram/circumcenter.h"
#include "voronoi2d/diagram/power_center.h"
#include "voronoi2d/sweep/planar_mesh.h"

namespace saddleback::voronoi2d {
namespace {

Numbering strips_of(const OrderedSites& sites, const JobStage& stage) {
  const NeighborLists lists =
      neighbors_of({.corners = {}, .twins = {}, .leaving = {}, .is_line = true}, sites, stage.part(0, 0.6));
  Numbering result;
  result.offsets = lists.offsets;
  result.corner_vertices.assign(lists.neighbors.size(), k_none);
  result.side_edges.resize(lists.neighbors.size());
  for (Index cell = 0; cell < sites.count(); ++cell) {
    stage.check();
    for (Index side = lists.offsets[cell]; side < lists.offsets[cell + 1]; ++side) {
      const Index other = lists.neighbors[side];
      if (other < cell) continue;
      const auto begin = lists.neighbors.begin() + lists.offsets[other];
      const Index twin = static_cast<Index>(std::find(begin, begin + 2, cell) - lists.neighbors.begin());
      result.side_edges[side] = result.side_edges[twin] = static_cast<Index>(result.edge_sites.size());
      result.edge_vertices.push_back({k_none, k_none});
      result.edge_sites.push_back({sites.original[other], sites.original[cell]});
    }
  }
  return result;
}

/// Cells in a row, whose numbers follow each other.
struct alignas(k_apart) Piece {
  Index begin, end;
  Index corners = 0, vertices = 0, edges = 0;               ///< how many come before
  std::vector<Index> deferred_sides{}, deferred_corners{};  ///< whose numbers are given in other pieces
};

class Numberer {
 public:
  Numberer(Triangulation& mesh, const OrderedSites& sites, int threads, Numbering& result, const JobStage& stage)
      : stage_(stage),
        mesh_(mesh),
        sites_(sites),
        threads_(thread_count(threads)),
        result_(result),
        scratch_(threads_),
        piece_size_(threads_ == 1 ? k_small : k_large),
        unscale_(1 / sites.scale) {
    const Index count = sites.count();
    for (Index begin = 0; begin < count; begin += piece_size_)
      pieces_.push_back({begin, std::min(count, begin + piece_size_)});
  }

  void run() {
    const std::size_t count = sites_.count();
    result_.offsets = std::move(mesh_.leaving);  // until it is a cell's turn, a half-edge from its site
    result_.offsets.resize(count + 1);
    result_.corner_vertices.resize(6 * count);
    result_.side_edges.resize(6 * count);
    result_.vertices.resize(2 * count);
    Counts all;
    if (threads_ == 1) {  // numbers follow without being counted before, and those of lower cells are known
      for (Piece& piece : pieces_) {
        stage_.update(0.8 * piece.begin / static_cast<double>(count));
        start_after(piece, all);
        add_to(all, number_piece(piece, 0, scratch_[0]));
      }
    } else {
      std::vector<Counts> counts(pieces_.size());
      for_pieces(stage_.part(0, 0.1), [&](Index i, int thread) { count_about(i, counts, scratch_[thread]); });
      for (std::size_t i = 0; i < pieces_.size(); ++i) {
        start_after(pieces_[i], all);
        add_to(all, counts[i]);
      }
      for_pieces(stage_.part(0.1, 0.7),
                 [&](Index i, int thread) { number_piece(pieces_[i], pieces_[i].begin, scratch_[thread]); });
      for_pieces(stage_.part(0.7, 0.8), [&](Index i, int) { resolve(pieces_[i]); });
    }
    result_.offsets.back() = all.corners;
    result_.corner_vertices.resize(all.corners);
    result_.side_edges.resize(all.corners);
    result_.vertices.resize(all.vertices);
    LargeArray<Index>().swap(mesh_.corners);
    LargeArray<Index>().swap(mesh_.twins);
    result_.edge_vertices.resize(all.edges);
    result_.edge_sites.resize(all.edges);
    for_pieces(stage_.part(0.8, 1), [&](Index i, int) {
      const bool is_last = static_cast<std::size_t>(i) + 1 == pieces_.size();
      list_edges(pieces_[i], is_last ? all.edges : pieces_[i + 1].edges);
    });
  }

 private:
  struct Counts {
    Index corners = 0, vertices = 0, edges = 0;
  };
  static constexpr Index k_small = 2048,
                         k_large = 8192;  ///< cells that stay in a core's cache; that outweigh a thread's start
  static constexpr Index k_ahead = 2048;  ///< sites: about a tile
  /// A worker's memory.
  struct alignas(k_apart) Scratch {
    CellBlock cells;
    std::vector<Index> around, triangles;       ///< of a large vertex: sites and places of its triangles' number
    Index first_half = k_none;                  ///< of those about it that no triangle of it is behind
    std::vector<Index> own_corners, own_sides;  ///< of the block's cells, that these give a number to
    Index own_corner_count = 0, own_side_count = 0;
  };

  static void start_after(Piece& piece, const Counts& before) {
    piece.corners = before.corners, piece.vertices = before.vertices, piece.edges = before.edges;
  }
  static void add_to(Counts& all, const Counts& more) {
    all.corners += more.corners, all.vertices += more.vertices, all.edges += more.edges;
  }

  template <class Work>
  void for_pieces(const JobStage& stage, Work&& work) {
    parallel_for(static_cast<Index>(pieces_.size()), threads_, 1, [&](Index i, int thread) {
      stage.update(i / static_cast<double>(pieces_.size()));
      work(i, thread);
    });
    stage.update(1);
  }

  bool is_flat(Index half) const { return (mesh_.twins[half | 3] >> (half & 3) & 1) != 0; }

  /// The vertex behind a half-edge, of more than three cells. Returns the lowest site about it.
  Index go_around(Index half, Scratch& scratch) const {
    scratch.around.clear();
    scratch.triangles.clear();
    Index walk = half, lowest = mesh_.corners[half];
    scratch.first_half = half;
    do {
      scratch.first_half = std::min(scratch.first_half, walk);
      lowest = std::min(lowest, mesh_.corners[walk]);
      scratch.around.push_back(mesh_.corners[walk]);
      scratch.triangles.push_back(walk | 3);
      walk = next_half(walk);
      while (is_flat(walk)) {
        walk = next_half(mesh_.twins[walk]);
        scratch.triangles.push_back(walk | 3);
      }
    } while (walk != half);
    return lowest;
  }

  bool is_large(Index half) const { return mesh_.twins[half | 3] != 0; }

  /// The corners and sides that a block's cells give a number to, which is hard to predict.
  static void select_own(Scratch& scratch) {
    const CellBlock& cells = scratch.cells;
    const std::size_t count = cells.size;
    if (count > scratch.own_sides.size()) {
      scratch.own_corners.resize(2 * count);
      scratch.own_sides.resize(2 * count);
    }
    const Index *const neighbor = cells.neighbors.data(), *const next = cells.next_neighbors.data(),
                       *const site = cells.sites.data();
    Index *const corners = scratch.own_corners.data(), *const sides = scratch.own_sides.data();
    std::size_t corner_count = 0, side_count = 0;
    for (std::size_t i = 0; i < count; ++i) {
      corners[corner_count] = sides[side_count] = static_cast<Index>(i);
      corner_count += std::min(neighbor[i], next[i]) > site[i];
      side_count += neighbor[i] > site[i];
    }
    scratch.own_corner_count = static_cast<Index>(corner_count);
    scratch.own_side_count = static_cast<Index>(side_count);
  }

  /// A tile's triangles are in the order of its circle's events: they are brought near before their cells' turn.
  void ask_for_triangles([[maybe_unused]] Index begin) const {
#ifdef __GNUC__
    constexpr Index k_line = 16;  // numbers that come at once
    const std::size_t first = static_cast<std::size_t>(8) * begin, size = mesh_.corners.size();
    for (std::size_t i = first; i < std::min(size, first + 8 * CellBlock::k_most); i += k_line) {
      __builtin_prefetch(&mesh_.corners[i]);
      __builtin_prefetch(&mesh_.twins[i]);
    }
#endif
  }

  /// Calls work() for each block of a piece's cells, which are in `scratch.cells`.
  template <class Work>
  void for_blocks(const Piece& piece, Scratch& scratch, Work&& work) const {
    for (Index begin = piece.begin; begin < piece.end; begin += CellBlock::k_most) {
      const Index count = std::min(CellBlock::k_most, piece.end - begin);
      ask_for_triangles(begin + k_ahead);
      scratch.cells.gather(mesh_, result_.offsets.data() + begin, begin, count, stage_);
      select_own(scratch);
      work(begin);
    }
  }

  /// Counts what a piece's triangles say of its cells and, at its border, of others.
  void count_about(Index piece, std::vector<Counts>& counts, Scratch& scratch) const {
    const Index *const corners = mesh_.corners.data(), *const twins = mesh_.twins.data();
    Counts own;
    const Index begin = pieces_[piece].begin, end = pieces_[piece].end;
    const auto count = [&](Index Counts::*what, Index site, Index more) {
      const Index of = site / piece_size_;
      if (of == piece)
        own.*what += more;
      else
        std::atomic_ref(counts[of].*what).fetch_add(more, std::memory_order_relaxed);
    };
    for (Index first = 8 * begin; first < 8 * end; first += 4) {
      if (corners[first] == k_none) continue;
      const Index flat = twins[first + 3], a = corners[first], b = corners[first + 1], c = corners[first + 2];
      if (flat == 0 && std::min({a, b, c}) >= begin && std::max({a, b, c}) < end &&
          (twins[first] | twins[first + 1] | twins[first + 2]) >= 0) {  // nearly all
        own.corners += 3;
        own.edges += static_cast<Index>(a < b) + static_cast<Index>(b < c) + static_cast<Index>(c < a);
        ++own.vertices;
        continue;
      }
      for (Index k = 0; k < 3; ++k) {
        const Index half = first + k, from = corners[half], to = corners[next_half(half)];
        const Index is_side = ~(flat >> k) & 1, is_border = static_cast<Index>(twins[half] < 0);
        count(&Counts::corners, from, is_side);
        count(&Counts::edges, from, is_side & static_cast<Index>(from < to));
        if (is_border == 0) continue;
        count(&Counts::corners, to, 1);
        count(&Counts::edges, to, static_cast<Index>(to < from));
      }
      if (flat == 0) {
        count(&Counts::vertices, std::min({a, b, c}), 1);
        continue;
      }
      for (Index k = 0; k < 3; ++k) {  // a large vertex counts once: at the first of the half-edges about it
        if ((flat >> k & 1) != 0) continue;
        const Index lowest = go_around(first + k, scratch);
        if (first + k == scratch.first_half) count(&Counts::vertices, lowest, 1);
      }
    }
    for (const auto what : {&Counts::corners, &Counts::vertices, &Counts::edges})
      std::atomic_ref(counts[piece].*what).fetch_add(own.*what, std::memory_order_relaxed);
  }

  /// Cells from `known` on have their numbers when it is this piece's turn.
  Counts number_piece(Piece& piece, Index known, Scratch& scratch) {
    Counts at{piece.corners, piece.vertices, piece.edges};
    const CellBlock& cells = scratch.cells;
    for_blocks(piece, scratch, [&](Index begin) {
      for (Index cell = 0; cell < cells.cell_count; ++cell)
        result_.offsets[begin + cell] = at.corners + cells.starts[cell];
      number_vertices(at.vertices, scratch);
      write_corners(piece, known, at.corners, scratch);
      write_sides(piece, known, at, scratch);
      at.corners += cells.size;
    });
    return {at.corners - piece.corners, at.vertices - piece.vertices, at.edges - piece.edges};
  }

  void number_vertices(Index& vertex, Scratch& scratch) {
    const CellBlock& cells = scratch.cells;
    const Index first = vertex;
    bool has_large = false;
    CellBlock::for_sides(0, scratch.own_corner_count, stage_, [&](Index k) {
      const Index i = scratch.own_corners[k], half = cells.halves[i];
      has_large |= is_large(half);
      if (!is_large(half)) {
        mesh_.corners[half | 3] = vertex++;
      } else if (go_around(half, scratch) == cells.sites[i]) {
        for (const Index triangle : scratch.triangles) mesh_.corners[triangle] = vertex;
        const std::size_t size = scratch.around.size();  // three evenly about it: their circle is well determined
        place(vertex++, cells.sites[i], scratch.around[size / 3], scratch.around[2 * size / 3]);
      }
    });
    if (!has_large && sites_.weights.empty()) return place_row(first, scratch);
    CellBlock::for_sides(0, scratch.own_corner_count, stage_, [&](Index k) {
      const Index i = scratch.own_corners[k], half = cells.halves[i];
      if (!is_large(half)) place(mesh_.corners[half | 3], cells.sites[i], cells.neighbors[i], cells.next_neighbors[i]);
    });
  }

  /// Vertices in a row, one for each corner that the block's cells give a number to.
  void place_row(Index first, const Scratch& scratch) {
    const CellBlock& cells = scratch.cells;
    const Index *const own = scratch.own_corners.data(), count = scratch.own_corner_count;
    const SiteColumns columns{sites_.x.data(), sites_.y.data()};
    Vec2* const to = result_.vertices.data() + first;
    CellBlock::for_sides(0, (count + 1) / 2, stage_, [&](Index pair) {
      const Index k = 2 * pair, i = own[k], j = own[std::min(k + 1, count - 1)];
      const Index a[3] = {cells.sites[i], cells.neighbors[i], cells.next_neighbors[i]},
                  b[3] = {cells.sites[j], cells.neighbors[j], cells.next_neighbors[j]};
      const TwoCenters centers(columns, a, b);
      if (centers.are_good()) {
        to[k] = Vec2(centers.x[0], centers.y[0]) * unscale_;
        if (k + 1 < count) to[k + 1] = Vec2(centers.x[1], centers.y[1]) * unscale_;
      } else {
        place(first + k, a[0], a[1], a[2]);
        if (k + 1 < count) place(first + k + 1, b[0], b[1], b[2]);
      }
    });
  }

  /// Calls work(begin, end, whether some numbers may be given in other pieces) for sides of cells in a row.
  template <class Work>
  static void for_runs(const CellBlock& cells, Index known, Work&& work) {
    const auto may_be_deferred = [&](Index cell) { return known > 0 && cells.lowest[cell] < known; };
    for (Index cell = 0, end; cell < cells.cell_count; cell = end) {
      const bool is_deferred = may_be_deferred(cell);
      for (end = cell + 1; end < cells.cell_count && may_be_deferred(end) == is_deferred;) ++end;
      work(cells.starts[cell], cells.starts[end], is_deferred);
    }
  }

  void write_corners(Piece& piece, Index known, Index corner, Scratch& scratch) {
    const CellBlock& cells = scratch.cells;
    const Index *const half = cells.halves.data(), *const numbers = mesh_.corners.data();
    Index* const to = result_.corner_vertices.data() + corner;
    for_runs(cells, known, [&](Index begin, Index end, bool may_be_deferred) {
      if (!may_be_deferred)
        return CellBlock::for_sides(begin, end, stage_, [&](Index i) { to[i] = numbers[half[i] | 3]; });
      CellBlock::for_sides(begin, end, stage_, [&](Index i) {
        if (cells.next_neighbors[i] == k_none) return;  // at infinity: see below
        const bool is_deferred = lowest_about(i, scratch) < known;
        to[i] = is_deferred ? deferred(half[i] | 3) : numbers[half[i] | 3];
        if (is_deferred) piece.deferred_corners.push_back(corner + i);
      });
    });
    for (const Index cell : cells.open) to[cells.starts[cell + 1] - 1] = k_none;
  }

  /// The lowest site about a corner that is not at infinity.
  Index lowest_about(Index corner, Scratch& scratch) const {
    const CellBlock& cells = scratch.cells;
    if (is_large(cells.halves[corner])) return go_around(cells.halves[corner], scratch);
    return std::min({cells.sites[corner], cells.neighbors[corner], cells.next_neighbors[corner]});
  }

  static Index deferred(Index place) { return -2 - place; }

  void write_sides(Piece& piece, Index known, Counts& at, Scratch& scratch) {
    const CellBlock& cells = scratch.cells;
    const Index *const half = cells.halves.data(), *const neighbor = cells.neighbors.data();
    Index *const sides = result_.side_edges.data() + at.corners, *const twins = mesh_.twins.data();
    CellBlock::for_sides(0, scratch.own_side_count, stage_, [&](Index k) {
      const Index side = half[scratch.own_sides[k]], twin = twins[side];
      // At the border the cell on the other side may be gathered meanwhile, which only looks whether it is negative.
      std::atomic_ref(twins[twin < 0 ? side : twin]).store(~(at.edges + k), std::memory_order_relaxed);
    });
    for_runs(cells, known, [&](Index begin, Index end, bool may_be_deferred) {
      if (!may_be_deferred)
        return CellBlock::for_sides(begin, end, stage_, [&](Index i) { sides[i] = ~twins[half[i]]; });
      CellBlock::for_sides(begin, end, stage_, [&](Index i) {
        const bool is_deferred = neighbor[i] < known;
        sides[i] = is_deferred ? half[i] : ~twins[half[i]];
        if (is_deferred) piece.deferred_sides.push_back(at.corners + i);
      });
    });
    for (Index k = 0; k < scratch.own_side_count; ++k) sides[scratch.own_sides[k]] = at.edges + k;
    at.edges += scratch.own_side_count;
  }

  void resolve(const Piece& piece) {
    for (const Index side : piece.deferred_sides) {
      Index& edge = result_.side_edges[side];
      edge = ~mesh_.twins[edge];
    }
    for (const Index corner : piece.deferred_corners) {
      Index& vertex = result_.corner_vertices[corner];
      vertex = mesh_.corners[deferred(vertex)];
    }
  }

  predicates::Point2 point(Index rank) const { return {sites_.x[rank], sites_.y[rank]}; }

  void place(Index vertex, Index a, Index b, Index c) {
    const auto weighted = [&](Index site) {
      return predicates::PowerPoint2{sites_.x[site], sites_.y[site], sites_.weights[site]};
    };
    result_.vertices[vertex] = (sites_.weights.empty() ? circumcenter(point(a), point(b), point(c))
                                                       : power_center(weighted(a), weighted(b), weighted(c))) *
                               unscale_;
  }

  /// The edges of a piece's cells, from these alone. The cell that gave an edge its number, the first on it, is to its
  /// left, the other to its right; only if it comes from infinity it is turned.
  void list_edges(const Piece& piece, Index edges_end) {
    const Index *const offsets = result_.offsets.data(), *const corners = result_.corner_vertices.data(),
                       *const sides = result_.side_edges.data();
    std::array<Index, 2>*const edge_vertices = result_.edge_vertices.data(), *const edge_sites =
                                                                                 result_.edge_sites.data();
    Index next = piece.edges;
    for (Index cell = piece.begin; cell < piece.end; ++cell) {
      const Index end = offsets[cell + 1], site = sites_.original[cell], first_own = next;
      Index from = corners[end - 1];
      Index at = offsets[cell];
      if (from >= 0 && next + end - at < edges_end) {
        for (; at < end; ++at) {
          const Index edge = sides[at], is_own = static_cast<Index>(edge >= first_own), to = corners[at];
          edge_vertices[next] = {from, to};  // to be written once more if it is not the cell's own
          next += is_own;
          edge_sites[edge][static_cast<std::size_t>(1 - is_own)] = site;
          from = to;
        }
        continue;
      }
      for (; at < end; ++at) {
        const Index edge = sides[at], to = corners[at];
        const bool is_own = edge >= first_own, is_turned = from < 0;
        if (is_own) edge_vertices[next++] = is_turned ? std::array{to, from} : std::array{from, to};
        edge_sites[edge][static_cast<std::size_t>(is_turned || (!is_own && to >= 0))] = site;
        from = to;
      }
    }
  }

  JobStage stage_;
  Triangulation& mesh_;
  const OrderedSites& sites_;
  int threads_;
  Numbering& result_;
  std::vector<Scratch> scratch_;
  Index piece_size_;
  double unscale_;  ///< of a power of two: exact
  std::vector<Piece> pieces_;
};

}  // namespace

Numbering number(Triangulation&& triangulation, const OrderedSites& sites, int threads, const JobStage& stage) {
  if (triangulation.is_line) return strips_of(sites, stage);
  Triangulation mesh = std::move(triangulation);
  Numbering result;
  Numberer(mesh, sites, threads, result, stage).run();
  return result;
}

}  // namespace saddleback::voronoi2d
