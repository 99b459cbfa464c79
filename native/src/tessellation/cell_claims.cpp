#include "tessellation/cell_claims.h"

#include <algorithm>

#include "saddleback/error.h"

#include "support/parallel.h"

namespace saddleback {
namespace {

void check_components(const Mesh& mesh, const SurfacePoints& sites) {
  std::vector<std::uint8_t> has_site(mesh.component_count(), 0);
  for (const SurfacePoint& site : sites) has_site[mesh.component_of(mesh.triangles()[site.face][0])] = 1;
  const auto bare = static_cast<Index>(std::find(has_site.begin(), has_site.end(), 0) - has_site.begin());
  if (bare == mesh.component_count()) return;
  Index vertex = 0;
  while (mesh.component_of(vertex) != bare) ++vertex;
  const auto count = std::count(has_site.begin(), has_site.end(), 0);
  throw InputError(message("sites: ", count, " of the mesh's ", mesh.component_count(), " separate parts ",
                           count == 1 ? "has" : "have", " no site, first the part of vertex ", vertex,
                           "; put at least one site on every part"));
}

bool before(const FaceClaim& a, const FaceClaim& b) { return a.face != b.face ? a.face < b.face : a.site < b.site; }

EdgeLine line_along(const FaceClaim& claim, Index halfedge) {
  return {claim.site, claim.squared_distance(halfedge % 3), claim.squared_distance(Mesh::next(halfedge) % 3)};
}

/// The nearest of two sites at an edge's start and at its end, as lower_envelope tells them; `a` is the smaller site.
std::array<Index, 2> winners(const EdgeLine& a, const EdgeLine& b) {
  return {a.at_start <= b.at_start ? a.site : b.site, a.at_end <= b.at_end ? a.site : b.site};
}

}  // namespace

void check_sites(const Mesh& mesh, const SurfacePoints& sites) {
  if (sites.empty()) throw InputError("sites: wanted at least one site, got none");
  check_surface_points(mesh, sites, "sites");
  check_components(mesh, sites);
}

/// A thread's own memory.
struct CellClaims::Worker {
  explicit Worker(const SiteMaps& maps) : scratch(maps), known(k_known) {}
  SiteMaps::Scratch scratch;
  std::vector<FaceClaim> claims;
  std::vector<Wish> wishes;
  std::vector<EdgeLine> lines;
  std::vector<EdgePiece> pieces;

  /// A vertex beside a cell has several faces there: its last answers are kept.
  struct Known {
    Index vertex = k_none, site = k_none;
    SiteVector vector;
  };
  static constexpr std::size_t k_known = 256;
  std::vector<Known> known;
  const SiteVector& vector(const SiteMaps& maps, Index vertex, Index site) {
    Known& entry = known[static_cast<std::size_t>(vertex) % k_known];
    if (entry.vertex != vertex || entry.site != site) entry = {vertex, site, maps.from(site, vertex, scratch)};
    return entry.vector;
  }
};

CellClaims::CellClaims(const SaddleVertexGraph& graph, const SurfacePoints& sites, int threads, const JobStage& stage)
    : maps_(graph, sites, threads, stage.part(0, 0.7)), shared_index_(graph.mesh().face_count(), k_none), first_{0} {
  std::vector<Worker> workers(thread_count(threads), Worker(maps_));
  claim_by_corners(workers, threads, stage);
  stage.update(0.85);
  spread(sites, workers, threads, stage);
  stage.update(1);
}

/// Each label of a face's corners claims it where they differ.
void CellClaims::claim_by_corners(std::vector<Worker>& workers, int threads, const JobStage& stage) {
  for (Index face = 0; face < mesh().face_count(); ++face) {
    const Triangle& t = mesh().triangles()[face];
    const Index a = maps_.label(t[0]), b = maps_.label(t[1]), c = maps_.label(t[2]);
    if (a == b && b == c) continue;
    shared_index_[face] = shared_count();
    faces_.push_back(face);
    first_.push_back(first_.back() + (a != b && b != c && c != a ? 3 : 2));
  }
  claims_.resize(first_.back());
  parallel_for(shared_count(), threads, 256, [&](Index shared, int thread) {
    stage.check();
    const Triangle& t = mesh().triangles()[faces_[shared]];
    std::array<Index, 3> labels{maps_.label(t[0]), maps_.label(t[1]), maps_.label(t[2])};
    std::sort(labels.begin(), labels.end());
    Index place = first_[shared];
    for (int i = 0; i < 3; ++i) {
      if (i == 0 || labels[i] != labels[i - 1])
        claims_[place++] = make_claim(faces_[shared], labels[i], workers[thread]);
    }
  });
}

/// Claims of sites on the faces in which they lie.
std::vector<CellClaims::Wish> CellClaims::wishes_of_sites(const SurfacePoints& sites) const {
  std::vector<Wish> wishes;
  for (Index site = 0; site < site_count(); ++site) wish_for(sites[site].face, site, wishes);
  return wishes;
}

FaceClaim CellClaims::make_claim(Index face, Index site, Worker& worker) const {
  const Triangle& t = mesh().triangles()[face];
  FaceClaim claim{face, site, {}};
  for (int i = 0; i < 3; ++i) claim.corner[i] = worker.vector(maps_, t[i], site);
  return claim;
}

/// Claims beyond the edges of faces with new claims, until there are no new ones.
void CellClaims::spread(const SurfacePoints& sites, std::vector<Worker>& workers, int threads, const JobStage& stage) {
  std::vector<Index> changed = faces_;
  std::vector<Wish> wishes = wishes_of_sites(sites);
  while (!changed.empty() || !wishes.empty()) {
    parallel_for(static_cast<Index>(changed.size()), threads, 256, [&](Index i, int thread) {
      stage.check();
      find_wishes(changed[i], workers[thread]);
    });
    for (Worker& worker : workers) {
      wishes.insert(wishes.end(), worker.wishes.begin(), worker.wishes.end());
      worker.wishes.clear();
    }
    std::sort(wishes.begin(), wishes.end());
    wishes.erase(std::unique(wishes.begin(), wishes.end()), wishes.end());
    const auto known = static_cast<Index>(late_.size());
    late_.resize(late_.size() + wishes.size());
    parallel_for(static_cast<Index>(wishes.size()), threads, 64, [&](Index i, int thread) {
      late_[known + i] = make_claim(wishes[i].face, wishes[i].site, workers[thread]);
    });
    std::inplace_merge(late_.begin(), late_.begin() + known, late_.end(), before);
    changed.clear();
    for (const Wish& wish : wishes) {
      if (changed.empty() || changed.back() != wish.face) changed.push_back(wish.face);
    }
    wishes.clear();
  }
  if (!late_.empty()) merge_late();
}

/// Puts the late claims in their places among the others.
void CellClaims::merge_late() {
  std::vector<FaceClaim> all(claims_.size() + late_.size());
  std::merge(claims_.begin(), claims_.end(), late_.begin(), late_.end(), all.begin(), before);
  claims_ = std::move(all);
  late_ = {};
  faces_.clear();
  first_.clear();
  for (std::size_t i = 0; i < claims_.size(); ++i) {
    if (i > 0 && claims_[i].face == claims_[i - 1].face) continue;
    shared_index_[claims_[i].face] = shared_count();
    faces_.push_back(claims_[i].face);
    first_.push_back(static_cast<Index>(i));
  }
  first_.push_back(claim_count());
}

std::span<const FaceClaim> CellClaims::late_claims(Index face) const {
  const auto [first, last] = std::equal_range(late_.begin(), late_.end(), FaceClaim{face, 0, {}},
                                              [](const FaceClaim& a, const FaceClaim& b) { return a.face < b.face; });
  return {first, last};
}

template <class Visit>
void CellClaims::visit_claims(Index face, Visit&& visit) const {
  if (shared_index_[face] != k_none) {
    for (const FaceClaim& claim : claims(shared_index_[face])) visit(claim);
  }
  for (const FaceClaim& claim : late_claims(face)) visit(claim);
}

void CellClaims::find_wishes(Index face, Worker& worker) const {
  for (Index h = 3 * face; h < 3 * face + 3; ++h) {
    const Index twin = mesh().twin(h);
    if (twin == k_none) continue;
    worker.lines.clear();
    visit_claims(face, [&](const FaceClaim& claim) { worker.lines.push_back(line_along(claim, h)); });
    if (worker.lines.size() == 2) {
      for (const Index site : winners(worker.lines[0], worker.lines[1]))
        wish_for(Mesh::face_of(twin), site, worker.wishes);
      continue;
    }
    lower_envelope(worker.lines, worker.pieces);
    for (const EdgePiece& piece : worker.pieces) wish_for(Mesh::face_of(twin), piece.site, worker.wishes);
  }
}

/// A claim on the face unless it is there; on a face that one cell owned so far, one of that cell, too.
void CellClaims::wish_for(Index face, Index site, std::vector<Wish>& wishes) const {
  bool shared = false, known = false;
  visit_claims(face, [&](const FaceClaim& claim) {
    shared = true;
    known = known || claim.site == site;
  });
  if (known || (!shared && face_site(face) == site)) return;
  if (!shared) wishes.push_back({face, face_site(face)});
  wishes.push_back({face, site});
}

void CellClaims::lines_along(Index shared, Index halfedge, std::vector<EdgeLine>& lines) const {
  lines.clear();
  for (const FaceClaim& claim : claims(shared)) lines.push_back(line_along(claim, halfedge));
}

}  // namespace saddleback
