// Method: blocks of shared faces, each divided by itself and its points and pieces counted from 0, are written one
// after the other.

#include "tessellation/cells/cell_complex.h"

#include <algorithm>
#include <span>
#include <utility>

#include "saddleback/support/large_array.h"

#include "support/threads/parallel.h"
#include "support/work_done.h"
#include "tessellation/bisectors/face_partition.h"

namespace saddleback {
namespace {

class CellComplex {
 public:
  CellComplex(const FaceCandidates& candidates, int threads, const JobStage& stage)
      : stage_(stage),
        candidates_(candidates),
        table_(candidates.table()),
        threads_(threads),
        edges_(3 * static_cast<std::size_t>(candidates.shared_count())),
        blocks_((candidates.shared_count() + k_block - 1) / k_block),
        workers_(thread_count(threads)) {
    for_each_block([&](Index begin, Index end, Block& block, Worker& worker) {
      for (Index shared = begin; shared < end; ++shared) break_edges(shared, block, worker);
    });
    Index breaks = 0;
    for (Block& block : blocks_) block.first_break = std::exchange(breaks, breaks + block.break_count);
    first_inner_ = table_.vertex_count + breaks;
    WorkDone done(stage, candidates.shared_count());
    for_each_block([&](Index begin, Index end, Block& block, Worker& worker) {
      for (Index shared = begin; shared < end; ++shared) divide(shared, block, worker);
      done.add(end - begin);
    });
  }

  void write(GeodesicVoronoi& cells) {
    Index points = first_inner_ - table_.vertex_count, pieces = 0, corners = 0;
    for (Block& block : blocks_) {
      block.first_point = std::exchange(points, points + static_cast<Index>(block.inner.size()));
      block.first_piece = std::exchange(pieces, pieces + static_cast<Index>(block.pieces.size()));
      block.first_corner = std::exchange(corners, corners + static_cast<Index>(block.corners.size()));
    }
    cells.points.resize(points);
    cells.pieces.resize(pieces);
    cells.piece_vertices.resize(corners);
    cells.piece_barycentric.resize(corners);
    for_each_block([&](Index begin, Index end, const Block& block, Worker&) {
      for (Index h = 3 * begin; h < 3 * end; ++h) write_breaks(3 * candidates_.face(h / 3) + h % 3, cells.points);
      std::ranges::copy(block.inner, cells.points.begin() + block.first_point);
      std::ranges::copy(block.barycentric, cells.piece_barycentric.begin() + block.first_corner);
      std::ranges::transform(block.pieces, cells.pieces.begin() + block.first_piece, [&](GeodesicVoronoi::Piece piece) {
        piece.first += block.first_corner;
        return piece;
      });
      const Index shift = block.first_point - (first_inner_ - table_.vertex_count);
      std::ranges::transform(block.corners, cells.piece_vertices.begin() + block.first_corner,
                             [&](Index vertex) { return vertex < first_inner_ ? vertex : vertex + shift; });
    });
  }

 private:
  static constexpr Index k_block = 256;  ///< shared faces

  /// Holds what a thread finds of shared faces that follow each other.
  struct alignas(k_apart) Block {
    std::vector<EdgePiece> edge_pieces;  ///< of the edges that its faces tell of
    Index break_count = 0;
    SurfacePoints inner;
    std::vector<GeodesicVoronoi::Piece> pieces;
    std::vector<Index> corners;  ///< of the pieces: vertices, inner ones as if there were no other block's
    std::vector<Vec3> barycentric;
    Index first_break = 0, first_point = 0, first_piece = 0, first_corner = 0;  ///< among those of all blocks
  };
  /// Breaks of an edge, where they are in its block.
  struct EdgeBreaks {
    Index first_piece, piece_count, first_break;
  };
  struct Edge {
    std::span<const EdgePiece> pieces;  ///< along the edge's own half-edge
    Index first_vertex;                 ///< of the breaks
    bool is_along;                      ///< which was asked for
  };
  struct alignas(k_apart) Worker {
    std::vector<EdgeLine> lines;
    std::vector<EdgePiece> pieces;
    std::vector<FacePlane> planes;
    FacePartition partition;
    std::vector<Index> sites, breaks, number;
    std::vector<Vec3> place;
  };

  template <class Visit>
  void for_each_block(Visit&& visit) {
    parallel_for(static_cast<Index>(blocks_.size()), threads_, 1, [&](Index i, int thread) {
      const Index begin = i * k_block, end = std::min(candidates_.shared_count(), begin + k_block);
      visit(begin, end, blocks_[i], workers_[thread]);
    });
  }

  /// Returns the half-edge along which an edge's breaks are told.
  Index edge_halfedge(Index h) const {
    const Index twin = table_.twins[h];
    return twin == k_none ? h : std::min(h, twin);
  }
  /// Returns which half-edge tells of the edge of one in a shared face: the first that lies in a shared face.
  Index first_halfedge(Index h) const {
    const Index along = edge_halfedge(h);
    return candidates_.shared_index(Mesh::face_of(along)) == k_none ? h : along;
  }
  std::size_t edge_index(Index first_halfedge) const {
    return 3 * static_cast<std::size_t>(candidates_.shared_index(Mesh::face_of(first_halfedge))) + first_halfedge % 3;
  }

  void break_edges(Index shared, Block& block, Worker& worker) {
    const Index face = candidates_.face(shared);
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      if (first_halfedge(h) != h) continue;
      candidates_.lines_along(shared, h, worker.lines);
      if (h != edge_halfedge(h))
        for (EdgeLine& line : worker.lines) std::swap(line.at_start, line.at_end);
      lower_envelope(worker.lines, worker.pieces);
      const auto count = static_cast<Index>(worker.pieces.size());
      edges_[edge_index(h)] = {static_cast<Index>(block.edge_pieces.size()), count, block.break_count};
      block.edge_pieces.insert(block.edge_pieces.end(), worker.pieces.begin(), worker.pieces.end());
      block.break_count += count - 1;
    }
  }

  Edge edge_of(Index h) const {
    const std::size_t index = edge_index(first_halfedge(h));
    const EdgeBreaks& edge = edges_[index];
    const Block& block = blocks_[index / (3 * k_block)];
    return {std::span(block.edge_pieces).subspan(edge.first_piece, edge.piece_count),
            table_.vertex_count + block.first_break + edge.first_break, h == edge_halfedge(h)};
  }

  void write_breaks(Index h, SurfacePoints& points) const {
    if (first_halfedge(h) != h) return;
    const Index along = edge_halfedge(h);
    const Edge edge = edge_of(h);
    for (std::size_t i = 1; i < edge.pieces.size(); ++i) {
      SurfacePoint& point = points[edge.first_vertex - table_.vertex_count + i - 1];
      point = {Mesh::face_of(along), Vec3::Zero()};
      point.barycentric[along % 3] = 1 - edge.pieces[i].begin;
      point.barycentric[(along + 1) % 3] = edge.pieces[i].begin;
    }
  }

  void divide(Index shared, Block& block, Worker& worker) const {
    worker.planes.clear();
    for (const FaceCandidate& candidate : candidates_.candidates(shared))
      worker.planes.push_back({candidate.site, candidate.squared_distance});
    const Index face = candidates_.face(shared);
    if (!worker.partition.build(worker.planes, stage_) || !agrees_with_edges(face, worker))
      worker.partition.build_star({side_of(face, 0), side_of(face, 1), side_of(face, 2)});
    add_pieces(face, block, worker);
  }

  /// Returns what the edge says about the face's side, in the face's own direction.
  FacePartition::Side side_of(Index face, int side) const {
    const Edge edge = edge_of(3 * face + side);
    FacePartition::Side result;
    for (const EdgePiece& piece : edge.pieces) result.sites.push_back(piece.site);
    for (std::size_t i = 1; i < edge.pieces.size(); ++i)
      result.breaks.push_back(edge.is_along ? edge.pieces[i].begin : 1 - edge.pieces[i].begin);
    if (!edge.is_along) {
      std::ranges::reverse(result.sites);
      std::ranges::reverse(result.breaks);
    }
    return result;
  }

  bool agrees_with_edges(Index face, Worker& worker) const {
    for (int side = 0; side < 3; ++side) {
      const Edge edge = edge_of(3 * face + side);
      worker.partition.read_side(side, worker.sites, worker.breaks);
      if (!edge.is_along) std::ranges::reverse(worker.sites);
      if (!std::ranges::equal(worker.sites, edge.pieces, {}, {}, &EdgePiece::site)) return false;
    }
    return true;
  }

  /// Numbers the partition's vertices and appends its pieces. Vertices on sides become the edges' own.
  void add_pieces(Index face, Block& block, Worker& worker) const {
    const auto& vertices = worker.partition.vertices();
    std::vector<Index>& number = worker.number;
    std::vector<Vec3>& place = worker.place;
    number.assign(vertices.size(), k_none);
    place.resize(vertices.size());
    for (int corner = 0; corner < 3; ++corner) {
      number[corner] = table_.triangles[face][corner];
      place[corner] = Vec3::Unit(corner);
    }
    for (int side = 0; side < 3; ++side) {
      const Edge edge = edge_of(3 * face + side);
      worker.partition.read_side(side, worker.sites, worker.breaks);
      const auto count = static_cast<Index>(worker.breaks.size());
      for (Index i = 0; i < count; ++i) {
        const Index on_edge = edge.is_along ? i : count - 1 - i, vertex = worker.breaks[i];
        const double t = edge.pieces[on_edge + 1].begin;
        number[vertex] = edge.first_vertex + on_edge;
        place[vertex] = Vec3::Zero();
        place[vertex][side] = edge.is_along ? 1 - t : t;
        place[vertex][(side + 1) % 3] = edge.is_along ? t : 1 - t;
      }
    }
    for (const FacePartition::Piece& piece : worker.partition.pieces()) {
      block.pieces.push_back(
          {face, piece.site, static_cast<Index>(block.corners.size()), static_cast<Index>(piece.loop.size())});
      for (const Index v : piece.loop) {
        if (number[v] == k_none) {
          number[v] = first_inner_ + static_cast<Index>(block.inner.size());
          place[v] = vertices[v].barycentric;
          block.inner.push_back({face, place[v]});
        }
        block.corners.push_back(number[v]);
        block.barycentric.push_back(place[v]);
      }
    }
  }

  const JobStage& stage_;
  const FaceCandidates& candidates_;
  const FaceTable& table_;
  const int threads_;
  LargeArray<EdgeBreaks> edges_;  ///< three a shared face; those that its half-edges tell of have a value
  std::vector<Block> blocks_;
  std::vector<Worker> workers_;
  Index first_inner_ = 0;  ///< vertices from here on are inner points of faces
};

}  // namespace

GeodesicVoronoi divide_faces(const FaceCandidates& candidates, int threads, const JobStage& stage) {
  constexpr Index k_chunk = 4096;
  const FaceTable& table = candidates.table();
  GeodesicVoronoi cells;
  CellComplex(candidates, threads, stage.part(0, 0.9)).write(cells);
  cells.vertex_cell.resize(table.vertex_count);
  cells.vertex_distance.resize(table.vertex_count);
  parallel_for(table.vertex_count, threads, k_chunk, [&](Index v, int) {
    cells.vertex_cell[v] = candidates.label(v);
    cells.vertex_distance[v] = candidates.distance(v);
  });
  cells.face_cell.resize(table.face_count());
  parallel_for(table.face_count(), threads, k_chunk,
               [&](Index face, int) { cells.face_cell[face] = candidates.face_site(face); });
  stage.update(1);
  return cells;
}

}  // namespace saddleback
