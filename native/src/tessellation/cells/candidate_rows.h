#pragma once
// Candidates of faces: the sites that may own a part of them.

#include <array>
#include <span>
#include <vector>

#include "tessellation/bisectors/edge_envelope.h"
#include "tessellation/log_map/site_labels.h"

namespace saddleback {

/// A site that may own a part of a face, and where the face's corners are from it in its tangent plane. There are many:
/// nothing is told twice.
struct CellCandidate {
  Index face, site;
  std::array<PackedVec2, 3> corner;
  double squared_distance(int i) const { return corner[i].squaredNorm(); }
  EdgeLine line_along(Index side) const {
    return {site, squared_distance(side % 3), squared_distance(Mesh::next(side) % 3)};
  }
};

/// The candidates of the faces that several sites may share; the others belong to one cell. Faces are in the order of
/// VertexRings.
class CandidateRows {
 public:
  struct Row {
    Index face, first, count;
  };
  explicit CandidateRows(const VertexRings& rings) : rings_(&rings) {}

  /// Begins with the mixed faces, whose corners differ in their labels, each with room for a candidate of each label.
  void begin(const SiteLabels& labels, int threads);
  /// Gives the rows places behind the others; candidates are to be filled in, then `add` makes them those of their
  /// faces.
  void make_room(std::span<Row> rows);
  void add(std::span<const Row> rows);
  /// Gives the sites of candidates other numbers, or k_none.
  void renumber(std::span<const Index> now);

  Index shared_count() const { return static_cast<Index>(rows_.size()); }
  /// The first of them are the mixed ones.
  Index mixed_count() const { return mixed_count_; }
  Index face(Index shared) const { return rows_[shared].face; }
  /// Number of a face among the shared ones, k_none for others.
  Index shared_index(Index face) const { return shared_index_[face]; }
  /// Candidates of a shared face, by site. Their corners are the face's.
  std::span<const CellCandidate> candidates(Index shared) const {
    return {candidates_.data() + rows_[shared].first, static_cast<std::size_t>(rows_[shared].count)};
  }
  std::span<CellCandidate> candidates(Index shared) { return of(rows_[shared]); }
  std::span<CellCandidate> of(const Row& row) {
    return {candidates_.data() + row.first, static_cast<std::size_t>(row.count)};
  }
  /// Candidates of any face; none where it is not shared.
  std::span<const CellCandidate> on(Index face) const {
    if (shared_index_.empty() || shared_index_[face] == k_none) return {};
    return candidates(shared_index_[face]);
  }
  /// Tells whether a face about the node is shared.
  bool is_at_border(Index node) const { return at_border_[node] != 0; }
  /// The shared faces from one face up to another, by their numbers: in order, the mixed ones, then those that cells
  /// without a vertex of theirs cross.
  struct Stretch {
    Index first, last, first_late, last_late;
  };
  Stretch within(Index first_face, Index end_face) const;

 private:
  void mark_border(Index face);

  const VertexRings* rings_;
  LargeArray<Index> shared_index_;  ///< by face
  LargeArray<Row> rows_;
  Index mixed_count_ = 0;
  LargeArray<CellCandidate> candidates_;
  std::vector<std::uint8_t> at_border_;  ///< by node
};

}  // namespace saddleback
