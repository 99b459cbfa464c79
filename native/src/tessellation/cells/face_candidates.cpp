#include "tessellation/cells/face_candidates.h"

#include <algorithm>

namespace saddleback {

void FaceCandidates::lines_along(Index shared, Index halfedge, std::vector<EdgeLine>& lines) const {
  lines.clear();
  for (const FaceCandidate& candidate : candidates(shared)) lines.push_back(candidate.line_along(halfedge));
}

CandidatesOfCells::CandidatesOfCells(const CellCandidates& cells)
    : FaceCandidates(FaceTable::of(cells.maps().graph().mesh()), cells.labels().site_count()),
      cells_(cells),
      graph_(cells.maps().graph()) {
  for (Index shared = 0; shared < cells.rows().shared_count(); ++shared)
    faces_.push_back(cells.rings().face(cells.rows().face(shared)).in_mesh);
  std::ranges::sort(faces_);
  for (Index i = 0; i < shared_count(); ++i) {
    shared_index_[faces_[i]] = i;
    const auto candidates = cells.rows().on(cells.rings().face_of(faces_[i]));
    for (const CellCandidate& candidate : candidates) {
      const std::array<double, 3> squared{candidate.squared_distance(0), candidate.squared_distance(1),
                                          candidate.squared_distance(2)};
      candidates_.push_back({faces_[i], candidate.site, squared});
    }
    first_.push_back(static_cast<Index>(candidates_.size()));
  }
}

}  // namespace saddleback
