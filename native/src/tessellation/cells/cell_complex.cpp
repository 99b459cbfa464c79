#include "tessellation/cells/cell_complex.h"

#include <algorithm>

#include "support/threads/parallel.h"

namespace saddleback {
namespace {

void reverse(std::vector<EdgeLine>& lines) {
  for (EdgeLine& line : lines) std::swap(line.at_start, line.at_end);
}

}  // namespace

CellComplex::CellComplex(const FaceCandidates& candidates, int threads, const JobStage& stage)
    : candidates_(candidates) {
  break_edges();
  stage.update(0.3);
  divide_faces(threads, stage.part(0.3, 0.9));
  label_vertices();
  stage.update(1);
}

/// The half-edge along which an edge's breaks are stored.
Index CellComplex::edge_halfedge(Index h) const {
  const Index twin = table().twins[h];
  return twin == k_none ? h : std::min(h, twin);
}

void CellComplex::break_edges() {
  edge_index_.assign(table().halfedge_count(), k_none);
  std::vector<EdgeLine> lines;
  for (Index shared = 0; shared < candidates_.shared_count(); ++shared) {
    const Index face = candidates_.face(shared);
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      const Index along = edge_halfedge(h);
      if (edge_index_[along] != k_none) continue;
      edge_index_[along] = static_cast<Index>(edges_.size());
      EdgeBreaks& edge = edges_.emplace_back();
      candidates_.lines_along(shared, h, lines);
      if (h != along) reverse(lines);
      lower_envelope(lines, edge.pieces);
      edge.first_vertex = table().vertex_count + static_cast<Index>(added_.size());
      for (std::size_t i = 1; i < edge.pieces.size(); ++i) {
        SurfacePoint point{Mesh::face_of(along), Vec3::Zero()};
        point.barycentric[along % 3] = 1 - edge.pieces[i].begin;
        point.barycentric[(along + 1) % 3] = edge.pieces[i].begin;
        added_.push_back(point);
      }
    }
  }
}

void CellComplex::divide_faces(int threads, const JobStage& stage) {
  const Index count = candidates_.shared_count();
  constexpr Index k_block = 4096;  // partitions are kept for a block at a time and then numbered in order
  std::vector<FacePartition> partitions(std::min(count, k_block));
  for (Index begin = 0; begin < count; begin += k_block) {
    const Index size = std::min(k_block, count - begin);
    parallel_for(size, threads, 64, [&](Index i, int) { divide(begin + i, partitions[i]); });
    for (Index i = 0; i < size; ++i) add_pieces(candidates_.face(begin + i), partitions[i]);
    stage.update(static_cast<double>(begin + size) / count);
  }
}

void CellComplex::divide(Index shared, FacePartition& partition) const {
  std::vector<FacePlane> planes;
  for (const FaceCandidate& candidate : candidates_.candidates(shared)) {
    planes.push_back({candidate.site, candidate.squared_distance});
  }
  const Index face = candidates_.face(shared);
  if (partition.build(planes) && agrees_with_edges(face, partition)) return;
  partition.build_star({side_of(face, 0), side_of(face, 1), side_of(face, 2)});
}

/// Returns what the edge says about the face's side, in the face's own direction.
FacePartition::Side CellComplex::side_of(Index face, int side) const {
  const Index h = 3 * face + side, along = edge_halfedge(h);
  const auto& pieces = edges_[edge_index_[along]].pieces;
  FacePartition::Side result;
  for (const EdgePiece& piece : pieces) result.sites.push_back(piece.site);
  for (std::size_t i = 1; i < pieces.size(); ++i)
    result.breaks.push_back(h == along ? pieces[i].begin : 1 - pieces[i].begin);
  if (h != along) {
    std::reverse(result.sites.begin(), result.sites.end());
    std::reverse(result.breaks.begin(), result.breaks.end());
  }
  return result;
}

bool CellComplex::agrees_with_edges(Index face, const FacePartition& partition) const {
  std::vector<Index> sites, breaks;
  for (int side = 0; side < 3; ++side) {
    partition.read_side(side, sites, breaks);
    if (sites != side_of(face, side).sites) return false;
  }
  return true;
}

/// Numbers the partition's vertices and appends its pieces. Vertices on sides become the edges' own.
void CellComplex::add_pieces(Index face, const FacePartition& partition) {
  const auto& vertices = partition.vertices();
  std::vector<Index> number(vertices.size(), k_none);
  std::vector<Vec3> place(vertices.size());
  for (int corner = 0; corner < 3; ++corner) {
    number[corner] = table().triangles[face][corner];
    place[corner] = Vec3::Unit(corner);
  }
  std::vector<Index> sites, breaks;
  for (int side = 0; side < 3; ++side) {
    partition.read_side(side, sites, breaks);
    const Index h = 3 * face + side, along = edge_halfedge(h);
    const EdgeBreaks& edge = edges_[edge_index_[along]];
    const auto count = static_cast<Index>(breaks.size());
    for (Index i = 0; i < count; ++i) {
      const Index on_edge = h == along ? i : count - 1 - i;
      const double t = edge.pieces[on_edge + 1].begin;
      number[breaks[i]] = edge.first_vertex + on_edge;
      place[breaks[i]] = Vec3::Zero();
      place[breaks[i]][side] = h == along ? 1 - t : t;
      place[breaks[i]][(side + 1) % 3] = h == along ? t : 1 - t;
    }
  }
  for (const FacePartition::Piece& piece : partition.pieces()) {
    pieces_.push_back({face, piece.site, static_cast<Index>(loop_.size()), static_cast<Index>(piece.loop.size())});
    for (const Index v : piece.loop) {
      if (number[v] == k_none) {
        number[v] = table().vertex_count + static_cast<Index>(added_.size());
        place[v] = vertices[v].barycentric;
        added_.push_back({face, place[v]});
      }
      loop_.push_back(number[v]);
      loop_barycentric_.push_back(place[v]);
    }
  }
}

void CellComplex::label_vertices() {
  vertex_site_.resize(table().vertex_count);
  vertex_distance_.resize(table().vertex_count);
  for (Index v = 0; v < table().vertex_count; ++v) {
    vertex_site_[v] = candidates_.label(v);
    vertex_distance_[v] = candidates_.distance(v);
  }
}

}  // namespace saddleback
