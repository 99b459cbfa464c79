#include "tessellation/cell_claims.h"

#include <algorithm>
#include <unordered_map>

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

constexpr double k_unknown = -1;  ///< distance of a corner that is yet to be laid down

EdgeLine line_along(const FaceClaim& claim, Index halfedge) {
  return {claim.site, claim.squared_distance(halfedge % 3), claim.squared_distance(Mesh::next(halfedge) % 3)};
}

/// The nearest of two sites at an edge's start and at its end, as lower_envelope tells them.
std::array<Index, 2> winners(const EdgeLine& a, const EdgeLine& b) {
  const auto nearer = [&](double of_a, double of_b) {
    return of_a != of_b ? (of_a < of_b ? a.site : b.site) : std::min(a.site, b.site);
  };
  return {nearer(a.at_start, b.at_start), nearer(a.at_end, b.at_end)};
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
  std::vector<Wish> wishes;
  std::vector<EdgeLine> lines;
  std::vector<EdgePiece> pieces;

  /// A vertex beside a cell has several faces there: its last answers are kept.
  struct Known {
    Index vertex = k_none, site = k_none;
    bool found = false;
    SiteVector vector;
  };
  static constexpr std::size_t k_known = 256;
  std::vector<Known> known;
  const Known& find(const SiteMaps& maps, Index site, Index vertex) {
    Known& entry = known[static_cast<std::size_t>(vertex) % k_known];
    if (entry.vertex == vertex && entry.site == site) return entry;
    entry.vertex = vertex;
    entry.site = site;
    entry.found = maps.find(site, vertex, scratch, entry.vector);
    return entry;
  }
};

/// Corners that no path in the graph places: those of long faces that cells without vertices cross. The first face
/// that lays them decides, for all.
struct CellClaims::Laid {
  std::unordered_map<std::uint64_t, SiteVector> vectors;
  static std::uint64_t key(Index site, Index vertex) {
    return static_cast<std::uint64_t>(site) << 32 | static_cast<std::uint32_t>(vertex);
  }
};

CellClaims::CellClaims(const SaddleVertexGraph& graph, const VertexRings& rings, const SurfacePoints& sites,
                       std::span<const double> reaches, int threads, const JobStage& stage)
    : FaceClaims(graph.mesh(), static_cast<Index>(sites.size())),
      maps_(graph, rings, sites, reaches, threads, stage.part(0, 0.7)) {
  std::vector<Worker> workers(thread_count(threads), Worker(maps_));
  claim_by_corners(workers, threads, stage);
  stage.update(0.85);
  spread(sites, workers, threads, stage);
  stage.update(1);
}

/// Faces whose corners differ in their labels, each with the number of labels.
void CellClaims::find_mixed_faces(int threads) {
  struct Mixed {
    Index face, labels;
  };
  constexpr Index k_stretch = 16384;
  const Index count = mesh().face_count(), stretches = (count + k_stretch - 1) / k_stretch;
  std::vector<std::vector<Mixed>> found(stretches);
  parallel_for(stretches, threads, 1, [&](Index stretch, int) {
    for (Index face = stretch * k_stretch; face < std::min(count, (stretch + 1) * k_stretch); ++face) {
      const Triangle& t = mesh().triangles()[face];
      const Index a = maps_.label(t[0]), b = maps_.label(t[1]), c = maps_.label(t[2]);
      if (a != b || b != c) found[stretch].push_back({face, a != b && b != c && c != a ? 3 : 2});
    }
  });
  for (const std::vector<Mixed>& stretch : found) {
    for (const Mixed& mixed : stretch) {
      shared_index_[mixed.face] = shared_count();
      faces_.push_back(mixed.face);
      first_.push_back(first_.back() + mixed.labels);
    }
  }
}

/// Each label of a face's corners claims it where they differ.
void CellClaims::claim_by_corners(std::vector<Worker>& workers, int threads, const JobStage& stage) {
  find_mixed_faces(threads);
  claims_.resize(first_.back());
  const Laid none;  // each label has a corner next to the others
  parallel_for(shared_count(), threads, 256, [&](Index shared, int thread) {
    stage.check();
    const Triangle& t = mesh().triangles()[faces_[shared]];
    std::array<Index, 3> labels{maps_.label(t[0]), maps_.label(t[1]), maps_.label(t[2])};
    std::sort(labels.begin(), labels.end());
    Index place = first_[shared];
    for (int i = 0; i < 3; ++i) {
      if (i > 0 && labels[i] == labels[i - 1]) continue;
      make_claim(faces_[shared], labels[i], none, workers[thread], claims_[place++]);
    }
  });
}

/// Claims of sites on the faces in which they lie.
std::vector<CellClaims::Wish> CellClaims::wishes_of_sites(const SurfacePoints& sites) const {
  std::vector<Wish> wishes;
  for (Index site = 0; site < site_count(); ++site) wish_for({sites[site].face, site, k_none}, wishes);
  return wishes;
}

/// False where corners are left to be laid down.
bool CellClaims::make_claim(Index face, Index site, const Laid& laid, Worker& worker, FaceClaim& claim) const {
  const Triangle& t = mesh().triangles()[face];
  claim = {face, site, {}};
  bool complete = true;
  for (int i = 0; i < 3; ++i) {
    const Worker::Known& known = worker.find(maps_, site, t[i]);
    claim.corner[i] = known.vector;
    if (known.found) continue;
    const auto found = laid.vectors.find(Laid::key(site, t[i]));
    if (found != laid.vectors.end())
      claim.corner[i] = found->second;
    else
      claim.corner[i].distance = k_unknown, complete = false;
  }
  return complete;
}

/// Completes a claim from the same site's on the face beyond the half-edge.
void CellClaims::lay_corners(Index halfedge, Laid& laid, FaceClaim& claim) const {
  const int start = halfedge % 3, end = Mesh::next(halfedge) % 3, apex = Mesh::prev(halfedge) % 3;
  const Index twin = mesh().twin(halfedge);
  visit_claims(Mesh::face_of(twin), [&](const FaceClaim& beyond) {
    if (beyond.site != claim.site) return;
    claim.corner[start] = beyond.corner[Mesh::next(twin) % 3];
    claim.corner[end] = beyond.corner[twin % 3];
  });
  if (claim.corner[apex].distance != k_unknown) return;
  const auto key = Laid::key(claim.site, mesh().apex(halfedge));
  claim.corner[apex] =
      laid.vectors.try_emplace(key, maps_.laid_beside(halfedge, claim.corner[start], claim.corner[end])).first->second;
}

/// Makes the claims that are wished for; each face and site once.
void CellClaims::grant(const std::vector<Wish>& wishes, Laid& laid, std::vector<Worker>& workers, int threads) {
  const auto count = static_cast<Index>(wishes.size());
  std::vector<FaceClaim> granted(count);
  std::vector<std::uint8_t> complete(count);
  parallel_for(count, threads, 64, [&](Index i, int thread) {
    complete[i] = make_claim(wishes[i].face, wishes[i].site, laid, workers[thread], granted[i]);
  });
  for (Index i = 0; i < count; ++i) {
    if (!complete[i] && wishes[i].halfedge != k_none) lay_corners(wishes[i].halfedge, laid, granted[i]);
  }
  for (const FaceClaim& claim : granted) {
    Index& index = late_index_[claim.face];
    if (index == k_none) {
      index = static_cast<Index>(late_.size());
      late_.emplace_back();
    }
    late_[index].push_back(claim);
  }
}

/// Claims beyond the edges of faces with new claims, until there are no new ones.
void CellClaims::spread(const SurfacePoints& sites, std::vector<Worker>& workers, int threads, const JobStage& stage) {
  std::vector<Index> changed = faces_;
  Laid laid;
  late_index_.assign(mesh().face_count(), k_none);
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
    const auto same = [](const Wish& a, const Wish& b) { return a.face == b.face && a.site == b.site; };
    wishes.erase(std::unique(wishes.begin(), wishes.end(), same), wishes.end());
    grant(wishes, laid, workers, threads);
    changed.clear();
    for (const Wish& wish : wishes) {
      if (changed.empty() || changed.back() != wish.face) changed.push_back(wish.face);
    }
    wishes.clear();
  }
  if (!late_.empty()) merge_late();
  late_index_ = {};
}

/// Puts the late claims in their places among the others.
void CellClaims::merge_late() {
  std::vector<FaceClaim> all;
  std::vector<Index> faces, first;
  for (Index face = 0; face < mesh().face_count(); ++face) {
    if (shared_index_[face] == k_none && late_index_[face] == k_none) continue;
    faces.push_back(face);
    first.push_back(static_cast<Index>(all.size()));
    visit_claims(face, [&](const FaceClaim& claim) { all.push_back(claim); });
    if (late_index_[face] != k_none) {
      std::sort(all.begin() + first.back(), all.end(),
                [](const FaceClaim& a, const FaceClaim& b) { return a.site < b.site; });
    }
  }
  first.push_back(static_cast<Index>(all.size()));
  claims_ = std::move(all);
  faces_ = std::move(faces);
  first_ = std::move(first);
  for (Index i = 0; i < shared_count(); ++i) shared_index_[faces_[i]] = i;
  late_ = {};
}

template <class Visit>
void CellClaims::visit_claims(Index face, Visit&& visit) const {
  if (shared_index_[face] != k_none) {
    for (const FaceClaim& claim : claims(shared_index_[face])) visit(claim);
  }
  if (late_index_[face] == k_none) return;
  for (const FaceClaim& claim : late_[late_index_[face]]) visit(claim);
}

void CellClaims::find_wishes(Index face, Worker& worker) const {
  for (Index h = 3 * face; h < 3 * face + 3; ++h) {
    const Index twin = mesh().twin(h);
    if (twin == k_none) continue;
    worker.lines.clear();
    visit_claims(face, [&](const FaceClaim& claim) { worker.lines.push_back(line_along(claim, h)); });
    if (worker.lines.size() == 2) {
      for (const Index site : winners(worker.lines[0], worker.lines[1]))
        wish_for({Mesh::face_of(twin), site, twin}, worker.wishes);
      continue;
    }
    lower_envelope(worker.lines, worker.pieces);
    for (const EdgePiece& piece : worker.pieces) wish_for({Mesh::face_of(twin), piece.site, twin}, worker.wishes);
  }
}

/// A claim on the face unless it is there; on a face that one cell owned so far, one of that cell, too.
void CellClaims::wish_for(const Wish& wish, std::vector<Wish>& wishes) const {
  bool shared = false, known = false;
  visit_claims(wish.face, [&](const FaceClaim& claim) {
    shared = true;
    known = known || claim.site == wish.site;
  });
  if (known || (!shared && face_site(wish.face) == wish.site)) return;
  if (!shared) wishes.push_back({wish.face, face_site(wish.face), k_none});
  wishes.push_back(wish);
}

void FaceClaims::lines_along(Index shared, Index halfedge, std::vector<EdgeLine>& lines) const {
  lines.clear();
  for (const FaceClaim& claim : claims(shared)) lines.push_back(line_along(claim, halfedge));
}

}  // namespace saddleback
