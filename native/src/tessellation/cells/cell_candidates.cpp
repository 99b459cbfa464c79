#include "tessellation/cells/cell_candidates.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "saddleback/error.h"

#include "support/threads/parallel.h"

namespace saddleback {
namespace {

void check_components(const Mesh& mesh, const SurfacePoints& sites, const char* when) {
  std::vector<std::uint8_t> has_site(mesh.component_count(), 0);
  for (const SurfacePoint& site : sites) has_site[mesh.component_of(mesh.triangles()[site.face][0])] = 1;
  const auto bare = static_cast<Index>(std::find(has_site.begin(), has_site.end(), 0) - has_site.begin());
  if (bare == mesh.component_count()) return;
  Index vertex = 0;
  while (mesh.component_of(vertex) != bare) ++vertex;
  const auto count = std::count(has_site.begin(), has_site.end(), 0);
  throw InputError(message("sites: ", when, count, " of the mesh's ", mesh.component_count(), " separate parts ",
                           count == 1 ? "has" : "have", " no site, first the part of vertex ", vertex,
                           "; put at least one site on every part"));
}

std::vector<VerticesBeside> one_for_each_thread(CellLogMaps& maps, int threads) {
  std::vector<VerticesBeside> beside;
  beside.reserve(thread_count(threads));
  for (int i = 0; i < thread_count(threads); ++i) beside.emplace_back(maps);
  return beside;
}

}  // namespace

void check_sites(const Mesh& mesh, const SurfacePoints& sites, const char* when) {
  if (sites.empty()) throw InputError("sites: wanted at least one site, got none");
  check_surface_points(mesh, sites, "sites");
  check_components(mesh, sites, when);
}

CellCandidates::CellCandidates(const SaddleVertexGraph& graph, const VertexRings& rings, CellLengths lengths,
                               int threads, int cuda_device)
    : threads_(threads),
      maps_(graph, rings, lengths, cuda_device),
      beside_(one_for_each_thread(maps_, threads)),
      rows_(rings),
      spread_(maps_, beside_, threads),
      before_{CandidateRows(rings), {}} {}

void CellCandidates::find(const SurfacePoints& sites, const JobStage& stage) {
  if (!std::exchange(is_complete_, false)) {
    find_once(sites, {}, {}, stage);
  } else {
    find_once(sites, reaches(sites), sites_that_moved(sites), stage);
  }
  is_complete_ = true;
  // Where most sites move they move little; where few do, cells beside them may grow much.
  if (labels().keeps_any()) look_farther(stage);
  stage.update(1);
}

void CellCandidates::look_farther(const JobStage& stage) {
  std::vector<Index> sites;
  for (Index site = 0; site < labels().site_count(); ++site)
    if (corners_.farthest[site] > maps_.seen().limit(site)) sites.push_back(site);
  if (sites.empty()) return;
  is_complete_ = false;
  const std::vector<std::uint8_t> as_before = std::move(is_as_before_);
  const std::vector<double> without_end(labels().site_count(), std::numeric_limits<double>::infinity());
  find_once(SurfacePoints(labels().sites()), without_end, std::move(sites), JobStage(stage));
  for (Index site = 0; site < labels().site_count(); ++site) is_as_before_[site] &= as_before[site];
  is_complete_ = true;
}

/// `others` as for SiteLabels.
void CellCandidates::find_once(const SurfacePoints& sites, std::span<const double> reaches,
                               const std::optional<std::vector<Index>>& others, const JobStage& stage) {
  maps_.label_nodes(sites, reaches, others, threads_, stage.part(0, 0.6));
  begin_sites();
  rows_.begin(labels(), threads_);
  place_cells(stage);
  if (labels().keeps_any()) keep_candidates();
  stage.update(0.85);
  spread_.run(sites, before_, rows_, corners_, stage);
  compare();
}

/// Places cell by cell, whose own vertices and those beside it are in reach then, and adds each label of a face's
/// corners to its candidates where they differ.
void CellCandidates::place_cells(const JobStage& stage) {
  for (VerticesBeside& beside : beside_) beside.forget();
  constexpr Index k_chunk = 4;
  const std::vector<Index>& order = labels().sites_along_curve();
  const Index count = labels().site_count();
  parallel_for(count, threads_, k_chunk, [&](Index i, int thread) {
    stage.check();
    const Index site = order[i];
    const bool goes_on = (i + 1) % k_chunk != 0 && i + 1 < count;  // else another thread may place the next
    if (goes_on) beside_[thread].fetch_cell(order[i + 1]);
    if (before_.keeps(site)) return;
    beside_[thread].place_cell(site);
    double& farthest = corners_.farthest[site];
    for (const Index node : labels().nodes(site))
      if (rows_.is_at_border(node)) farthest = std::max(farthest, add_from(node, site, beside_[thread]));
  });
}

/// Adds the site to the candidates of the shared faces about a node that have no earlier node of the cell's. Tells how
/// far it sees their corners.
double CellCandidates::add_from(Index node, Index site, VerticesBeside& beside) {
  const SiteVector own = maps_.own(node);
  double farthest = own.distance;
  Index last = k_none;  // the wedge before ends where this one begins
  SiteVector at_last;
  for (const VertexRings::Wedge& wedge : rings().around(node)) {
    const Index from = labels().label(wedge.from), to = labels().label(wedge.to);
    if ((from == site && (to == site || wedge.from < node)) || (to == site && wedge.to < node)) continue;
    const Index face = wedge.side / 3, start = wedge.side % 3;
    CellCandidate& candidate = rows_.candidates(rows_.shared_index(face))[(from < site) + (to < site && to != from)];
    candidate.face = face;
    candidate.site = site;
    if (wedge.from != last) beside.find(site, wedge.from, at_last);  // each is beside the cell
    candidate.corner[start] = at_last.log;
    farthest = std::max(farthest, at_last.distance);
    last = wedge.to;
    beside.find(site, last, at_last);
    candidate.corner[Mesh::next(start)] = at_last.log;
    candidate.corner[Mesh::prev(start)] = own.log;
    farthest = std::max(farthest, at_last.distance);
  }
  return farthest;
}

}  // namespace saddleback
