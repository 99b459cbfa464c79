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

/// The half-edges that leave a site and are sides of its cell, counter-clockwise; of an open cell the last one comes
/// from the last neighbour instead.
class Star {
 public:
  void gather(const Triangulation& mesh, Index site) {
    size_ = 0;
    is_open = false;
    const Index first = mesh.leaving[site];
    Index half = first;
    do {
      if ((mesh.twins[half | 3] >> (half & 3) & 1) == 0) add(half, mesh.corners[next_half(half)]);
      const Index last = previous_half(half);
      half = mesh.twins[last];
      if (half < 0) {
        is_open = true;
        add(last, mesh.corners[last]);
      }
    } while (half >= 0 && half != first);
    if (!is_open) lowest_first();
  }
  Index size() const { return size_; }
  Index half(Index i) const { return sides_[i].half; }
  Index neighbour(Index i) const { return sides_[i].neighbour; }
  bool is_open = false;

 private:
  struct Side {
    Index half, neighbour;
  };
  void add(Index half, Index neighbour) {
    if (size_ == static_cast<Index>(sides_.size())) sides_.resize(2 * sides_.size());
    sides_[size_++] = {half, neighbour};
  }
  void lowest_first() {
    Index lowest = 0;
    for (Index i = 1; i < size_; ++i) lowest = sides_[i].neighbour < sides_[lowest].neighbour ? i : lowest;
    if (2 * size_ > static_cast<Index>(sides_.size())) sides_.resize(2 * size_);
    std::copy_n(sides_.begin(), lowest, sides_.begin() + size_);
    std::copy_n(sides_.begin() + lowest, size_, sides_.begin());
  }
  std::vector<Side> sides_ = std::vector<Side>(32);
  Index size_ = 0;
};

/// A vertex of more than three cells, with three of them evenly about it, so that their circle is well determined.
struct LargeVertex {
  Index vertex, sites[3];
};

/// Cells in a row, whose numbers follow each other.
struct Piece {
  Index begin, end;
  Index corners = 0, vertices = 0, edges = 0;  ///< how many come before
  Index corners_end = 0, edges_end = 0;
  std::vector<LargeVertex> large{};
};

class Numberer {
 public:
  Numberer(Triangulation& mesh, const OrderedSites& sites, int threads, Numbering& result)
      : mesh_(mesh), sites_(sites), threads_(thread_count(threads)), result_(result), scratch_(threads_) {
    constexpr Index k_small = 2048, k_large = 8192;  // cells that stay in a core's cache; that outweigh a thread's start
    const Index count = sites.count(), size = threads_ == 1 ? k_small : k_large;
    for (Index begin = 0; begin < count; begin += size) pieces_.push_back({begin, std::min(count, begin + size)});
  }

  void run(const JobStage& stage) {
    const std::size_t count = sites_.count();
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
        add_to(all, number_piece(piece, scratch_[0]));
        resolve(piece);
      }
    } else {
      std::vector<Counts> counts(pieces_.size());
      for_pieces(stage.part(0, 0.2), [&](Index i, int thread) { counts[i] = count_in(pieces_[i], scratch_[thread]); });
      for (std::size_t i = 0; i < pieces_.size(); ++i) {
        start_after(pieces_[i], all);
        add_to(all, counts[i]);
      }
      for_pieces(stage.part(0.2, 0.6), [&](Index i, int thread) { number_piece(pieces_[i], scratch_[thread]); });
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
    std::vector<Index> around, triangles;
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

  /// Whether no site about the vertex behind side i is below the star's own. For vertices of more than three cells
  /// fills in the sites and the triangles about them.
  bool is_own(Index site, Index i, Scratch& scratch) const {
    const Star& star = scratch.star;
    const Index next = star.neighbour(i + 1 == star.size() ? 0 : i + 1), half = star.half(i);
    if (std::min(star.neighbour(i), next) < site) return false;
    scratch.around.clear();
    if (mesh_.twins[half | 3] == 0) return true;
    scratch.triangles.clear();
    Index walk = half, lowest = site;
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
    return lowest == site;
  }

  Counts count_in(const Piece& piece, Scratch& scratch) const {
    Counts counts;
    const Star& star = scratch.star;
    for (Index site = piece.begin; site < piece.end; ++site) {
      scratch.star.gather(mesh_, site);
      counts.corners += star.size();
      for (Index i = 0; i < star.size(); ++i) counts.edges += star.neighbour(i) > site;
      for (Index i = 0; i < star.size() - star.is_open; ++i) counts.vertices += is_own(site, i, scratch);
    }
    return counts;
  }

  /// Until `resolve`, sides whose edge is numbered elsewhere hold ~ the half-edge where its number will be, corners and
  /// ends of edges the place of their triangle's number.
  Counts number_piece(Piece& piece, Scratch& scratch) {
    const Star& star = scratch.star;
    Index corner = piece.corners, vertex = piece.vertices, edge = piece.edges;
    for (Index site = piece.begin; site < piece.end; ++site) {
      scratch.star.gather(mesh_, site);
      result_.offsets[site] = corner;
      Index before = star.is_open ? k_none : star.half(star.size() - 1) | 3;
      for (Index i = 0; i < star.size(); ++i, ++corner) {
        const Index half = star.half(i), place = star.is_open && i + 1 == star.size() ? k_none : half | 3;
        if (place != k_none && is_own(site, i, scratch)) add_vertex(piece, place, vertex++, scratch);
        result_.corner_vertices[corner] = place;
        const Index other = star.neighbour(i);
        result_.side_edges[corner] = other < site ? ~half : edge;
        if (other > site) {
          const Index twin = mesh_.twins[half];
          mesh_.twins[twin < 0 ? half : twin] = ~edge;
          result_.edge_vertices[edge] = {before, place};
          result_.edge_sites[edge] = {sites_.original[site], sites_.original[other]};
          ++edge;
        }
        before = place;
      }
    }
    piece.corners_end = corner;
    piece.edges_end = edge;
    return {corner - piece.corners, vertex - piece.vertices, edge - piece.edges};
  }

  void add_vertex(Piece& piece, Index place, Index vertex, const Scratch& scratch) {
    if (scratch.around.empty()) {
      mesh_.corners[place] = vertex;
      return;
    }
    for (const Index triangle : scratch.triangles) mesh_.corners[triangle] = vertex;
    const std::size_t size = scratch.around.size();  // the first is the cell that owns the vertex
    piece.large.push_back({vertex, {scratch.around[0], scratch.around[size / 3], scratch.around[2 * size / 3]}});
  }

  void resolve(const Piece& piece) {
    for (Index corner = piece.corners; corner < piece.corners_end; ++corner) {
      Index &side = result_.side_edges[corner], &vertex = result_.corner_vertices[corner];
      if (side < 0) side = ~mesh_.twins[~side];
      if (vertex != k_none) vertex = mesh_.corners[vertex];
    }
    for (Index edge = piece.edges; edge < piece.edges_end; ++edge) {
      std::array<Index, 2>& ends = result_.edge_vertices[edge];
      for (Index& end : ends)
        if (end != k_none) end = mesh_.corners[end];
      if (ends[0] == k_none) {
        std::swap(ends[0], ends[1]);
        std::swap(result_.edge_sites[edge][0], result_.edge_sites[edge][1]);
      }
    }
  }

  predicates::Point2 point(Index rank) const { return {sites_.x[rank], sites_.y[rank]}; }

  void place_vertices(Index count, const JobStage& stage) {
    const bool has_large = std::any_of(pieces_.begin(), pieces_.end(), [](const Piece& p) { return !p.large.empty(); });
    if (has_large) leave_out_flat_triangles();
    LargeArray<Index>().swap(mesh_.twins);  // the vertices can have the room
    result_.vertices.resize(count);
    const auto place = [&](Index vertex, Index a, Index b, Index c) {
      result_.vertices[vertex] = circumcentre(point(a), point(b), point(c)) / sites_.scale;
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
