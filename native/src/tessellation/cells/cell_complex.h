#pragma once
// The cells of sites as a subdivision of faces.

#include <vector>

#include "tessellation/bisectors/face_partition.h"
#include "tessellation/cells/face_candidates.h"

namespace saddleback {

/// Every face that several cells share is divided into convex pieces; the others belong to one cell. Breaks on mesh
/// edges are computed once an edge, so that the pieces of neighboring faces fit to the bit.
class CellComplex {
 public:
  /// Vertices 0..V-1 are the faces'; then come breaks on edges, then inner points of faces.
  struct Piece {
    Index face, site;
    Index first, count;  ///< in `loop` and `loop_barycentric`
  };

  /// The candidates must outlive the complex. \throw Cancelled.
  CellComplex(const FaceCandidates& candidates, int threads, const JobStage& stage);

  const FaceTable& table() const { return candidates_.table(); }
  const FaceCandidates& candidates() const { return candidates_; }
  Index site_count() const { return candidates_.site_count(); }
  /// The cell of a face that one cell owns whole, else k_none.
  Index face_site(Index face) const { return candidates_.face_site(face); }
  /// Pieces of the shared faces, ordered by face.
  const std::vector<Piece>& pieces() const { return pieces_; }
  const std::vector<Index>& loop() const { return loop_; }
  const std::vector<Vec3>& loop_barycentric() const { return loop_barycentric_; }
  /// Vertices that the faces do not have; vertex V + i is added()[i].
  const SurfacePoints& added() const { return added_; }
  const std::vector<Index>& vertex_site() const { return vertex_site_; }
  const std::vector<double>& vertex_distance() const { return vertex_distance_; }  ///< from vertex_site

 private:
  struct EdgeBreaks {
    std::vector<EdgePiece> pieces;  ///< along the edge's own half-edge
    Index first_vertex = k_none;
  };

  void break_edges();
  void divide_faces(int threads, const JobStage& stage);
  void divide(Index shared, FacePartition& partition) const;
  bool agrees_with_edges(Index face, const FacePartition& partition) const;
  FacePartition::Side side_of(Index face, int side) const;
  void add_pieces(Index face, const FacePartition& partition);
  void label_vertices();
  Index edge_halfedge(Index h) const;

  const FaceCandidates& candidates_;
  std::vector<Index> edge_index_;  ///< per half-edge, into edges_
  std::vector<EdgeBreaks> edges_;
  std::vector<Index> loop_, vertex_site_;
  std::vector<double> vertex_distance_;
  std::vector<Piece> pieces_;
  std::vector<Vec3> loop_barycentric_;
  SurfacePoints added_;
};

}  // namespace saddleback
