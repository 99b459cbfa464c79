#include <algorithm>

#include "tessellation/cells/cell_claims.h"

namespace saddleback {

void FaceClaims::lines_along(Index shared, Index halfedge, std::vector<EdgeLine>& lines) const {
  lines.clear();
  for (const FaceClaim& claim : claims(shared)) lines.push_back(claim.line_along(halfedge));
}

ClaimsOfCells::ClaimsOfCells(const CellClaims& cells)
    : FaceClaims(cells.maps().graph().mesh(), cells.site_count()), cells_(cells), graph_(cells.maps().graph()) {
  for (Index shared = 0; shared < cells.shared_count(); ++shared)
    faces_.push_back(cells.rings().face(cells.face(shared)).in_mesh);
  std::ranges::sort(faces_);
  for (Index i = 0; i < shared_count(); ++i) {
    shared_index_[faces_[i]] = i;
    const auto claims = cells.claims(cells.shared_index(cells.rings().face_of(faces_[i])));
    for (const CellClaim& claim : claims) {
      const std::array<double, 3> squared{claim.squared_distance(0), claim.squared_distance(1),
                                          claim.squared_distance(2)};
      claims_.push_back({faces_[i], claim.site, squared});
    }
    first_.push_back(static_cast<Index>(claims_.size()));
  }
}

}  // namespace saddleback
