// Cell by cell, in the order of their ranks: a site's triangles in turn are its corners, the half-edges that leave it
// its sides. A number is given at the lowest site about a vertex or beside an edge and left in the triangulation for
// the others: a vertex's beside the corners of its triangles, an edge's in place of a twin that is not needed any more.

#include "voronoi2d/half_edges.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "support/parallel.h"
#include "voronoi2d/circumcentre.h"
#include "voronoi2d/planar_mesh.h"

namespace saddleback::voronoi2d {
namespace {

Numbering strips_of(const OrderedSites& sites) {
  const NeighbourLists lists = neighbours_of({.corners = {}, .twins = {}, .leaving = {}, .is_line = true}, sites);
  Numbering result;
  result.offsets = lists.offsets;
  result.corner_vertices.assign(lists.neighbours.size(), k_none);
  result.side_edges.resize(lists.neighbours.size());
  for (Index cell = 0; cell < sites.count(); ++cell) {
    for (Index side = lists.offsets[cell]; side < lists.offsets[cell + 1]; ++side) {
      const Index other = lists.neighbours[side];
      if (other < cell) continue;
      const auto begin = lists.neighbours.begin() + lists.offsets[other];
      const Index twin = static_cast<Index>(std::find(begin, begin + 2, cell) - lists.neighbours.begin());
      result.side_edges[side] = result.side_edges[twin] = static_cast<Index>(result.edge_sites.size());
      result.edge_vertices.push_back({k_none, k_none});
      result.edge_sites.push_back({sites.original[other], sites.original[cell]});
    }
  }
  return result;
}

/// The half-edges that leave a site and are sides of its cell, counter-clockwise, beginning with the lowest neighbour;
/// of an open cell the last one comes from the last neighbour instead.
class Star {
 public:
  /// `first`: any half-edge from the site, at the border the one along it.
  void gather(const Triangulation& mesh, Index first) {
    Index found = 0, lowest = 0;
    is_open = false;
    Index half = first;
    do {
      if (found + 2 > static_cast<Index>(around_.size())) grow();
      const Index neighbour = mesh.corners[next_half(half)], last = previous_half(half);
      const bool is_side = (mesh.twins[half | 3] >> (half & 3) & 1) == 0;
      around_[found] = {half, neighbour};
      lowest = is_side && neighbour < around_[lowest].neighbour ? found : lowest;
      found += is_side;
      half = mesh.twins[last];
      if (half < 0) {
        is_open = true;
        around_[found++] = {last, mesh.corners[last]};
        lowest = 0;
      }
    } while (half >= 0 && half != first);
    for (Index i = 0, from = lowest; i < found; ++i) {
      sides_[i] = around_[from];
      from = from + 1 == found ? 0 : from + 1;
    }
    sides_[found] = sides_[0];
    size = found;
  }
  Index half(Index i) const { return sides_[i].half; }
  Index neighbour(Index i) const { return sides_[i].neighbour; }  ///< after the last comes the first again

  Index size = 0;
  bool is_open = false;

 private:
  struct Side {
    Index half, neighbour;
  };
  void grow() {
    around_.resize(2 * around_.size());
    sides_.resize(around_.size() + 1);
  }
  std::vector<Side> around_ = std::vector<Side>(32), sides_ = std::vector<Side>(33);
};

/// A vertex of more than three cells, with three of them evenly about it, so that their circle is well determined.
struct LargeVertex {
  Index vertex, sites[3];
};

/// Cells in a row, whose numbers follow each other.
struct Piece {
  Index begin, end;
  Index corners = 0, vertices = 0, edges = 0;  ///< how many come before
  std::vector<LargeVertex> large{};
  std::vector<Index> late_sides{}, late_corners{}, late_ends{};  ///< whose numbers are given in other pieces; 2 e + k
};

class Numberer {
 public:
  Numberer(Triangulation& mesh, const OrderedSites& sites, int threads, Numbering& result)
      : mesh_(mesh), sites_(sites), threads_(thread_count(threads)), result_(result), scratch_(threads_) {
    constexpr Index k_small = 2048,
                    k_large = 8192;  // cells that stay in a core's cache; that outweigh a thread's start
    const Index count = sites.count(), size = threads_ == 1 ? k_small : k_large;
    for (Index begin = 0; begin < count; begin += size) pieces_.push_back({begin, std::min(count, begin + size)});
  }

  void run(const JobStage& stage) {
    const std::size_t count = sites_.count();
    result_.offsets = std::move(mesh_.leaving);  // until it is a cell's turn, a half-edge from its site
    result_.offsets.resize(count + 1);
    result_.corner_vertices.resize(6 * count);
    result_.side_edges.resize(6 * count);
    result_.edge_vertices.resize(3 * count);
    result_.edge_sites.resize(3 * count);
    Counts all;
    if (threads_ == 1) {  // numbers follow without being counted before, and those of lower cells are known
      for (Piece& piece : pieces_) {
        stage.update(0.7 * piece.begin / static_cast<double>(count));
        start_after(piece, all);
        add_to(all, number_piece(piece, 0, scratch_[0]));
      }
    } else {
      std::vector<Counts> counts(pieces_.size());
      for_pieces(stage.part(0, 0.2), [&](Index i, int thread) { counts[i] = count_in(pieces_[i], scratch_[thread]); });
      for (std::size_t i = 0; i < pieces_.size(); ++i) {
        start_after(pieces_[i], all);
        add_to(all, counts[i]);
      }
      for_pieces(stage.part(0.2, 0.6),
                 [&](Index i, int thread) { number_piece(pieces_[i], pieces_[i].begin, scratch_[thread]); });
      for_pieces(stage.part(0.6, 0.7), [&](Index i, int) { resolve(pieces_[i]); });
    }
    result_.offsets.back() = all.corners;
    result_.corner_vertices.resize(all.corners);
    result_.side_edges.resize(all.corners);
    result_.edge_vertices.resize(all.edges);
    result_.edge_sites.resize(all.edges);
    place_vertices(all.vertices, stage.part(0.7, 1));
  }

 private:
  struct Counts {
    Index corners = 0, vertices = 0, edges = 0;
  };
  /// A worker's memory.
  struct Scratch {
    Star star;
    std::vector<Index> around, triangles;  ///< of a large vertex: sites and places of its triangles' number
    std::vector<Index> own, numbers;       ///< of a cell: corners or sides that it gives a number to; of its corners
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
      stage.check();
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
    do {
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

  /// Which of the items up to `count` satisfy a condition that is hard to predict, into `scratch.own`.
  template <class Condition>
  static Index select(Index count, Scratch& scratch, Condition&& is_wanted) {
    if (count > static_cast<Index>(scratch.own.size())) scratch.own.resize(2 * count);
    Index found = 0;
    for (Index i = 0; i < count; ++i) {
      scratch.own[found] = i;
      found += is_wanted(i);
    }
    return found;
  }
  static Index select_own_corners(Index site, Scratch& scratch) {
    const Star& star = scratch.star;
    return select(star.size - star.is_open, scratch,
                  [&](Index i) { return std::min(star.neighbour(i), star.neighbour(i + 1)) > site; });
  }
  static Index select_own_sides(Index site, Scratch& scratch) {
    const Star& star = scratch.star;
    return select(star.size, scratch, [&](Index i) { return star.neighbour(i) > site; });
  }

  Counts count_in(const Piece& piece, Scratch& scratch) const {
    Counts counts;
    for (Index site = piece.begin; site < piece.end; ++site) {
      scratch.star.gather(mesh_, result_.offsets[site]);
      counts.corners += scratch.star.size;
      counts.edges += select_own_sides(site, scratch);
      const Index own = select_own_corners(site, scratch);
      for (Index k = 0; k < own; ++k) {
        const Index half = scratch.star.half(scratch.own[k]);
        counts.vertices += !is_large(half) || go_around(half, scratch) == site;
      }
    }
    return counts;
  }

  /// Cells from `known` on have their numbers when it is this piece's turn.
  Counts number_piece(Piece& piece, Index known, Scratch& scratch) {
    Counts at{piece.corners, piece.vertices, piece.edges};
    for (Index site = piece.begin; site < piece.end; ++site) {
      scratch.star.gather(mesh_, result_.offsets[site]);
      result_.offsets[site] = at.corners;
      number_vertices(piece, site, at.vertices, scratch);
      write_corners(piece, site, known, at.corners, scratch);
      write_sides(piece, site, known, at, scratch);
      at.corners += scratch.star.size;
    }
    return {at.corners - piece.corners, at.vertices - piece.vertices, at.edges - piece.edges};
  }

  void number_vertices(Piece& piece, Index site, Index& vertex, Scratch& scratch) {
    const Index own = select_own_corners(site, scratch);
    for (Index k = 0; k < own; ++k) {
      const Index half = scratch.star.half(scratch.own[k]);
      if (!is_large(half)) {
        mesh_.corners[half | 3] = vertex++;
      } else if (go_around(half, scratch) == site) {
        for (const Index place : scratch.triangles) mesh_.corners[place] = vertex;
        const std::size_t size = scratch.around.size();
        piece.large.push_back({vertex, {site, scratch.around[size / 3], scratch.around[2 * size / 3]}});
        ++vertex;
      }
    }
  }

  void write_corners(Piece& piece, Index site, Index known, Index corner, Scratch& scratch) {
    const Star& star = scratch.star;
    if (star.size >= static_cast<Index>(scratch.numbers.size())) scratch.numbers.resize(2 * star.size + 1);
    Index* const numbers = scratch.numbers.data() + 1;  // and the last one again before the first
    for (Index i = 0; i < star.size - star.is_open; ++i) {
      const Index place = star.half(i) | 3;
      const Index lowest = is_large(place) && known > 0 ? go_around(star.half(i), scratch)
                                                        : std::min(star.neighbour(i), star.neighbour(i + 1));
      if (std::min(lowest, site) < known) {
        numbers[i] = late(place);
        piece.late_corners.push_back(corner + i);
      } else {
        numbers[i] = mesh_.corners[place];
      }
    }
    if (star.is_open) numbers[star.size - 1] = k_none;
    numbers[-1] = numbers[star.size - 1];
    std::copy_n(numbers, star.size, result_.corner_vertices.begin() + corner);
  }

  static Index late(Index place) { return -2 - place; }

  void write_sides(Piece& piece, Index site, Index known, Counts& at, Scratch& scratch) {
    const Star& star = scratch.star;
    const Index* const numbers = scratch.numbers.data() + 1;
    for (Index i = 0; i < star.size; ++i) {
      const bool is_late = star.neighbour(i) < known;
      if (is_late) piece.late_sides.push_back(at.corners + i);
      result_.side_edges[at.corners + i] = is_late ? star.half(i) : ~mesh_.twins[star.half(i)];  // or see below
    }
    const Index own = select_own_sides(site, scratch);
    for (Index k = 0; k < own; ++k) {
      const Index i = scratch.own[k], edge = at.edges++, half = star.half(i), twin = mesh_.twins[half];
      result_.side_edges[at.corners + i] = edge;
      mesh_.twins[twin < 0 ? half : twin] = ~edge;
      std::array<Index, 2> ends{numbers[i - 1], numbers[i]}, beside{site, star.neighbour(i)};
      if (ends[0] == k_none) {
        std::swap(ends[0], ends[1]);
        std::swap(beside[0], beside[1]);
      }
      for (Index end = 0; end < 2; ++end)
        if (ends[end] < k_none) piece.late_ends.push_back(2 * edge + end);
      result_.edge_vertices[edge] = ends;
      result_.edge_sites[edge] = {sites_.original[beside[0]], sites_.original[beside[1]]};
    }
  }

  void resolve(const Piece& piece) {
    for (const Index side : piece.late_sides) {
      Index& edge = result_.side_edges[side];
      edge = ~mesh_.twins[edge];
    }
    for (const Index corner : piece.late_corners) {
      Index& vertex = result_.corner_vertices[corner];
      vertex = mesh_.corners[late(vertex)];
    }
    for (const Index end : piece.late_ends) {
      Index& vertex = result_.edge_vertices[end / 2][end % 2];
      vertex = mesh_.corners[late(vertex)];
    }
  }

  predicates::Point2 point(Index rank) const { return {sites_.x[rank], sites_.y[rank]}; }

  void place_vertices(Index count, const JobStage& stage) {
    const bool has_large = std::any_of(pieces_.begin(), pieces_.end(), [](const Piece& p) { return !p.large.empty(); });
    if (has_large) leave_out_flat_triangles();
    LargeArray<Index>().swap(mesh_.twins);  // the vertices can have the room
    result_.vertices.resize(count);
    const double unscale = 1 / sites_.scale;  // of a power of two: exact
    const auto place = [&](Index vertex, Index a, Index b, Index c) {
      result_.vertices[vertex] = circumcentre(point(a), point(b), point(c)) * unscale;
    };
    for_pieces(stage, [&](Index i, int) {
      for (Index first = 8 * pieces_[i].begin; first < 8 * pieces_[i].end; first += 4) {
        const Index a = mesh_.corners[first], b = mesh_.corners[first + 1], c = mesh_.corners[first + 2],
                    vertex = mesh_.corners[first + 3];
        if (a == k_none) continue;
        const bool is_b = b < a && b < c, is_c = c < a && c < b;  // the lowest first, whatever the triangle's order
        place(vertex, is_b ? b : is_c ? c : a, is_b ? c : is_c ? a : b, is_b ? a : is_c ? b : c);
      }
      for (const LargeVertex& large : pieces_[i].large)
        place(large.vertex, large.sites[0], large.sites[1], large.sites[2]);
    });
  }

  void leave_out_flat_triangles() {
    for (std::size_t first = 0; first < mesh_.corners.size(); first += 4)
      if (mesh_.corners[first] != k_none && mesh_.twins[first + 3] != 0) mesh_.corners[first] = k_none;
  }

  Triangulation& mesh_;
  const OrderedSites& sites_;
  int threads_;
  Numbering& result_;
  std::vector<Scratch> scratch_;
  std::vector<Piece> pieces_;
};

}  // namespace

Numbering number(Triangulation&& triangulation, const OrderedSites& sites, int threads, const JobStage& stage) {
  if (triangulation.is_line) return strips_of(sites);
  Triangulation mesh = std::move(triangulation);
  Numbering result;
  Numberer(mesh, sites, threads, result).run(stage);
  return result;
}

}  // namespace saddleback::voronoi2d
