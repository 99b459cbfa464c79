#pragma once
// Candidates of faces by the faces and vertices of the mesh, whatever finds them.

#include <array>
#include <span>
#include <vector>

#include "saddleback/mesh/mesh.h"
#include "saddleback/support/large_array.h"

#include "tessellation/bisectors/edge_envelope.h"
#include "tessellation/cells/cell_candidates.h"
#include "tessellation/cells/face_table.h"

namespace saddleback {

/// A site that may own a part of a face, and how far the face's corners are from it. Squared, as they are compared:
/// roots would lose ties.
struct FaceCandidate {
  Index face, site;
  std::array<double, 3> squared_distance;  ///< of the corners
  EdgeLine line_along(Index halfedge) const {
    return {site, squared_distance[halfedge % 3], squared_distance[Mesh::next(halfedge) % 3]};
  }
};

/// The candidates on every face that several sites may share; the other faces belong to one cell.
class FaceCandidates {
 public:
  FaceCandidates(const FaceTable& faces, Index site_count)
      : table_(faces), site_count_(site_count), shared_index_(faces.face_count(), k_none), first_{0} {}
  virtual ~FaceCandidates() = default;

  const FaceTable& table() const { return table_; }
  Index site_count() const { return site_count_; }
  /// The site nearest to a vertex (ties: the smaller) and its distance. A face whose corners' labels differ is shared.
  virtual Index label(Index vertex) const = 0;
  virtual double distance(Index vertex) const = 0;

  /// The shared faces, in increasing order.
  Index shared_count() const { return static_cast<Index>(faces_.size()); }
  Index face(Index shared) const { return faces_[shared]; }
  /// Its candidates, by site.
  std::span<const FaceCandidate> candidates(Index shared) const {
    return {candidates_.data() + first_[shared], candidates_.data() + first_[shared + 1]};
  }
  /// Candidates are numbered face after face.
  Index candidate_count() const { return static_cast<Index>(candidates_.size()); }
  Index first_candidate(Index shared) const { return first_[shared]; }
  /// Number of a face among the shared ones, k_none for others.
  Index shared_index(Index face) const { return shared_index_[face]; }
  /// The cell that owns a face whole, k_none for shared ones.
  Index face_site(Index face) const {
    return shared_index_[face] == k_none ? label(table_.triangles[face][0]) : k_none;
  }

  /// The candidates' squared distances along a half-edge of a shared face, by site.
  void lines_along(Index shared, Index halfedge, std::vector<EdgeLine>& lines) const;

 protected:
  const FaceTable table_;
  const Index site_count_;
  LargeArray<Index> shared_index_, faces_, first_;
  LargeArray<FaceCandidate> candidates_;
};

/// Candidates of cells that a graph tells. The cells must outlive it.
class CandidatesOfCells final : public FaceCandidates {
 public:
  CandidatesOfCells(const CellCandidates& cells, int threads);
  Index label(Index vertex) const override { return cells_.labels().label(graph_.node_of(vertex)); }
  double distance(Index vertex) const override { return cells_.maps().own_distance(graph_.node_of(vertex)); }

 private:
  const CellCandidates& cells_;
  const SaddleVertexGraph& graph_;
};

}  // namespace saddleback
