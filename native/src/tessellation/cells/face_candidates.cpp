#include "tessellation/cells/face_candidates.h"

#include <algorithm>
#include <utility>

#include "support/threads/parallel.h"

namespace saddleback {

void FaceCandidates::lines_along(Index shared, Index halfedge, std::vector<EdgeLine>& lines) const {
  lines.clear();
  for (const FaceCandidate& candidate : candidates(shared)) lines.push_back(candidate.line_along(halfedge));
}

CandidatesOfCells::CandidatesOfCells(const CellCandidates& cells, int threads)
    : FaceCandidates(FaceTable::of(cells.maps().graph().mesh()), cells.labels().site_count()),
      cells_(cells),
      graph_(cells.maps().graph()) {
  constexpr Index k_block = 4096;  // faces, whose shared ones are counted, then written behind those before
  const CandidateRows& rows = cells.rows();
  const Index face_count = table_.face_count();
  std::vector<Index> shared((face_count + k_block - 1) / k_block), own(shared.size());
  const auto for_each_shared = [&](auto&& visit) {
    parallel_for(static_cast<Index>(shared.size()), threads, 1, [&](Index block, int) {
      Index number = shared[block], candidate = own[block];  // not counted where the other threads' are
      for (Index face = block * k_block; face < std::min(face_count, (block + 1) * k_block); ++face) {
        const auto candidates = rows.on(cells.rings().face_of(face));
        if (candidates.empty()) continue;
        visit(face, candidates, number, candidate);
        ++number;
        candidate += static_cast<Index>(candidates.size());
      }
      shared[block] = number;
      own[block] = candidate;
    });
  };
  for_each_shared([](Index, auto, Index, Index) {});
  Index all = 0, all_own = 0;
  for (Index& count : shared) count = std::exchange(all, all + count);
  for (Index& count : own) count = std::exchange(all_own, all_own + count);
  faces_.resize(all);
  first_.resize(all + 1);
  candidates_.resize(all_own);
  for_each_shared([&](Index face, std::span<const CellCandidate> candidates, Index number, Index first) {
    shared_index_[face] = number;
    faces_[number] = face;
    first_[number + 1] = first + static_cast<Index>(candidates.size());
    std::ranges::transform(candidates, candidates_.begin() + first, [&](const CellCandidate& candidate) {
      const std::array<double, 3> squared{candidate.squared_distance(0), candidate.squared_distance(1),
                                          candidate.squared_distance(2)};
      return FaceCandidate{face, candidate.site, squared};
    });
  });
}

}  // namespace saddleback
