#include "tessellation/cells/candidate_rows.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "support/threads/parallel.h"

namespace saddleback {

void CandidateRows::begin(const SiteLabels& labels_of, int threads) {
  constexpr Index k_stretch = 4096;
  const Index count = rings_->face_count(), stretches = (count + k_stretch - 1) / k_stretch;
  struct Sum {
    Index rows = 0, candidates = 0;
  };
  std::vector<Sum> sums(stretches);
  shared_index_.resize(count);
  const auto in_stretches = [&](auto&& visit) {
    parallel_for(stretches, threads, 1, [&](Index stretch, int) {
      Sum sum = sums[stretch];  // not counted where the other threads' are
      for (Index face = stretch * k_stretch; face < std::min(count, (stretch + 1) * k_stretch); ++face)
        visit(face, sum);
      sums[stretch] = sum;
    });
  };
  in_stretches([&](Index face, Sum& sum) {
    const auto& nodes = rings_->face(face).nodes;
    const Index a = labels_of.label(nodes[0]), b = labels_of.label(nodes[1]), c = labels_of.label(nodes[2]);
    const Index labels = a == b && b == c ? 1 : a != b && b != c && c != a ? 3 : 2;
    shared_index_[face] = labels;
    sum.rows += labels > 1;
    sum.candidates += labels > 1 ? labels : 0;
  });
  Sum all;
  for (Sum& sum : sums) {
    std::swap(sum, all);
    all = {all.rows + sum.rows, all.candidates + sum.candidates};
  }
  rows_.resize(all.rows);
  mixed_count_ = all.rows;
  at_border_.assign(labels_of.node_count(), 0);
  in_stretches([&](Index face, Sum& next) {
    const Index labels = std::exchange(shared_index_[face], k_none);
    if (labels == 1) return;
    shared_index_[face] = next.rows;
    rows_[next.rows++] = {face, next.candidates, labels};
    next.candidates += labels;
    mark_border(face);
  });
  constexpr Index k_later_share = 8;  // one late candidate for so many others there is room for
  if (candidates_.capacity() < static_cast<std::size_t>(all.candidates))
    candidates_.reserve(all.candidates + all.candidates / k_later_share);
  candidates_.resize(all.candidates);
}

/// May be called by several threads at once.
void CandidateRows::mark_border(Index face) {
  for (const Index node : rings_->face(face).nodes)
    std::atomic_ref(at_border_[node]).store(1, std::memory_order_relaxed);
}

void CandidateRows::make_room(std::span<Row> rows) {
  auto end = static_cast<Index>(candidates_.size());
  for (Row& row : rows) end += row.count, row.first = end - row.count;
  candidates_.resize(end);
}

void CandidateRows::add(std::span<const Row> rows) {
  for (const Row& row : rows) {
    Index& shared = shared_index_[row.face];
    if (shared == k_none) {
      shared = shared_count();
      rows_.emplace_back();
      mark_border(row.face);
    }
    rows_[shared] = row;
  }
}

void CandidateRows::renumber(std::span<const Index> now) {
  for (CellCandidate& candidate : candidates_)
    if (candidate.site != k_none) candidate.site = now[candidate.site];
}

CandidateRows::Stretch CandidateRows::within(Index first_face, Index end_face) const {
  const auto mixed_end = rows_.begin() + mixed_count_;
  const auto below = [](const Row& row, Index face) { return row.face < face; };
  const auto number = [&](auto begin, auto end, Index face) {
    return static_cast<Index>(std::lower_bound(begin, end, face, below) - rows_.begin());
  };
  return {number(rows_.begin(), mixed_end, first_face), number(rows_.begin(), mixed_end, end_face),
          number(mixed_end, rows_.end(), first_face), number(mixed_end, rows_.end(), end_face)};
}

}  // namespace saddleback
