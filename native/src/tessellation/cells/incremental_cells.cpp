// What CellCandidates keep of the cells before, where few sites move.

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <utility>

#include "saddleback/mesh/surface_curve.h"

#include "support/threads/parallel.h"
#include "tessellation/cells/cell_candidates.h"

namespace saddleback {

std::vector<Index> CellCandidates::sites_that_moved(const SurfacePoints& sites) const {
  std::vector<Index> moved;
  for (Index site = 0; site < static_cast<Index>(sites.size()); ++site) {
    const bool stays = site < labels().site_count() && labels().sites()[site].face == sites[site].face &&
                       labels().sites()[site].barycentric == sites[site].barycentric;
    if (!stays) moved.push_back(site);
  }
  return moved;
}

/// Tells how far sites may own something: as far as before, and as they have moved.
std::vector<double> CellCandidates::reaches(const SurfacePoints& sites) const {
  const Mesh& mesh = maps_.graph().mesh();
  std::vector<double> reaches(sites.size(), std::numeric_limits<double>::infinity());
  parallel_for(labels().site_count(), threads_, 128, [&](Index i, int) {
    const Index site = labels().sites_along_curve()[i];
    if (site >= static_cast<Index>(sites.size()) || !(corners_.farthest[site] > 0)) return;
    reaches[site] = corners_.farthest[site] + step_length(mesh, labels().sites()[site], sites[site]);
  });
  return reaches;
}

/// Keeps the candidates of cells that are kept, to be looked up; all others are made anew.
void CellCandidates::begin_sites() {
  const Index count = labels().site_count();
  if (labels().keeps_any()) std::swap(before_.rows, rows_);
  corners_.farthest.resize(count);
  corners_.is_extrapolated.resize(count);
  before_.is_kept.resize(count);
  for (Index site = 0; site < count; ++site) {
    const bool was_extrapolated = std::exchange(corners_.is_extrapolated[site], 0) != 0;
    before_.is_kept[site] = labels().is_kept(site) && !was_extrapolated;
    if (!before_.keeps(site)) corners_.farthest[site] = 0;
  }
}

void CellCandidates::renumber(std::span<const Index> before) {
  std::vector<Index> now(labels().site_count(), k_none);
  std::vector<double> farthest(before.size(), 0);
  std::vector<std::uint8_t> is_extrapolated(before.size(), 0);
  for (Index site = 0; site < static_cast<Index>(before.size()); ++site) {
    const Index old = before[site];
    if (old == k_none) continue;
    now[old] = site;
    farthest[site] = corners_.farthest[old];
    is_extrapolated[site] = corners_.is_extrapolated[old];
  }
  rows_.renumber(now);
  corners_.farthest.swap(farthest);
  corners_.is_extrapolated.swap(is_extrapolated);
  maps_.renumber(before);
}

/// Looks up the candidates of kept cells on faces whose corners' labels differ.
void CellCandidates::keep_candidates() {
  parallel_for(rows_.mixed_count(), threads_, 512, [&](Index shared, int) {
    const Index face = rows_.face(shared);
    std::array<Index, 3> sites;
    std::ranges::transform(rings().face(face).nodes, sites.begin(), [&](Index node) { return labels().label(node); });
    std::ranges::sort(sites);
    const auto rest = std::ranges::unique(sites);
    auto candidate = rows_.candidates(shared).begin();
    for (auto site = sites.begin(); site != rest.begin(); ++site, ++candidate)
      if (before_.keeps(*site)) *candidate = *before_.find(face, *site);
  });
}

/// Tells which cells have the parts of faces that they had.
void CellCandidates::compare() {
  const Index site_count = labels().site_count();
  is_as_before_.assign(site_count, labels().keeps_any());
  if (!labels().keeps_any()) return;
  const auto differ = [&](std::span<const CellCandidate> candidates) {
    for (const CellCandidate& candidate : candidates)
      if (candidate.site != k_none) std::atomic_ref(is_as_before_[candidate.site]).store(0, std::memory_order_relaxed);
  };
  for (Index site = 0; site < site_count; ++site)
    if (!before_.keeps(site)) is_as_before_[site] = 0;
  parallel_for(rows_.shared_count(), threads_, 512, [&](Index shared, int) {
    const std::span<const CellCandidate> now = rows_.candidates(shared), then = before_.rows.on(rows_.face(shared));
    const auto same = [&](const CellCandidate& a, const CellCandidate& b) {
      return a.site == b.site && before_.keeps(a.site);
    };
    if (std::ranges::equal(now, then, same)) return;
    differ(now);
    differ(then);
  });
  parallel_for(before_.rows.shared_count(), threads_, 512, [&](Index row, int) {
    const Index face = before_.rows.face(row);
    if (rows_.shared_index(face) == k_none) differ(before_.rows.on(face));
  });
}

}  // namespace saddleback
