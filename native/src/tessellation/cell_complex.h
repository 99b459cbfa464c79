#pragma once
// The cells of sites as a subdivision of the mesh's faces.

#include <vector>

#include "tessellation/edge_envelope.h"
#include "tessellation/face_partition.h"
#include "tessellation/site_maps.h"

namespace saddleback {

/// \throw InputError naming the first offender: no sites, more sites than vertices, a site off the mesh, a component
/// without a site.
void check_sites(const Mesh& mesh, const SurfacePoints& sites);

/// Every face that several cells share is divided into convex pieces; the others belong to one cell. Breaks on mesh
/// edges are computed once an edge, so that the pieces of neighbouring faces fit to the bit.
///
/// Candidates for a face start with the labels of its corners and the sites that lie in it; a site that wins part of an
/// edge becomes a candidate of the face beyond, until nothing changes. Thus cells smaller than a face, or without any
/// vertex, are found: a cell is connected, and its site's own face begins the walk.
class CellComplex {
 public:
  /// Vertices 0..V-1 are the mesh's; then come breaks on edges, then inner points of faces.
  struct Piece {
    Index face, site;
    Index first, count;  ///< in `loop` and `loop_barycentric`
  };

  /// The sites must have passed check_sites. \throw Cancelled.
  CellComplex(const SaddleVertexGraph& graph, const SurfacePoints& sites, int threads, const JobStage& stage);

  const Mesh& mesh() const { return mesh_; }
  const SiteMaps& maps() const { return maps_; }
  Index site_count() const { return site_count_; }
  /// The cell of a face that one cell owns whole, else k_none.
  Index face_site(Index face) const { return face_site_[face]; }
  /// Pieces of the shared faces, ordered by face.
  const std::vector<Piece>& pieces() const { return pieces_; }
  const std::vector<Index>& loop() const { return loop_; }
  const std::vector<Vec3>& loop_barycentric() const { return loop_barycentric_; }
  /// Vertices that the mesh does not have; vertex V + i is added()[i].
  const SurfacePoints& added() const { return added_; }
  const std::vector<Index>& vertex_site() const { return vertex_site_; }

 private:
  struct Shared {
    Index face;
    std::vector<Index> candidates;  ///< sorted
  };
  struct EdgeBreaks {
    std::vector<EdgePiece> pieces;  ///< along the edge's own half-edge
    Index first_vertex = k_none;
  };

  void find_candidates(const SurfacePoints& sites, const JobStage& stage);
  Index share(Index face);
  bool add_candidate(Shared& shared, Index site, Index halfedge);
  void lines_along(const Shared& shared, Index halfedge, std::vector<EdgeLine>& lines) const;
  void break_edges();
  void divide_faces(int threads, const JobStage& stage);
  void divide(const Shared& shared, FacePartition& partition) const;
  bool agrees_with_edges(Index face, const FacePartition& partition) const;
  FacePartition::Side side_of(Index face, int side) const;
  void add_pieces(Index face, const FacePartition& partition);
  void label_vertices();
  Index edge_halfedge(Index h) const;
  double squared_distance(Index vertex, Index site) const { return maps_.known_log(vertex, site).squaredNorm(); }

  const Mesh& mesh_;
  SiteMaps maps_;
  Index site_count_;
  std::vector<Index> face_shared_;  ///< index into shared_, k_none
  std::vector<Shared> shared_;
  std::vector<Index> edge_index_;  ///< per half-edge, into edges_
  std::vector<EdgeBreaks> edges_;
  std::vector<Index> face_site_, loop_, vertex_site_;
  std::vector<Piece> pieces_;
  std::vector<Vec3> loop_barycentric_;
  SurfacePoints added_;
};

}  // namespace saddleback
