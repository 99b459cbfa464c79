#include "tessellation/cells/cell_claims.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <queue>
#include <unordered_map>
#include <utility>

#include "saddleback/error.h"

#include "support/threads/parallel.h"

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

std::uint64_t pair_key(Index site, Index other) {
  return static_cast<std::uint64_t>(site) << 32 | static_cast<std::uint32_t>(other);
}

// Of a corner that is yet to be laid down.
constexpr double k_unknown = std::numeric_limits<double>::quiet_NaN();
bool is_unknown(const PackedVec2& corner) { return std::isnan(corner.x()); }

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
struct alignas(k_apart) CellClaims::Worker {
  explicit Worker(const SiteMaps& maps) : scratch(maps), known(k_known) {}
  SiteMaps::Scratch scratch;
  std::vector<Wish> wishes;
  std::vector<const CellClaim*> claims;
  std::vector<Index> fresh;
  std::vector<EdgeLine> lines;
  std::vector<EdgePiece> pieces;

  /// A vertex beside a cell has several faces there: its last answers are kept.
  struct Known {
    Index node = k_none, site = k_none;
    std::uint32_t round = 0;
    bool found = false;
    SiteVector vector;
  };
  static constexpr std::size_t k_known = 1 << 12;
  std::uint32_t round = 0;  ///< answers of earlier ones are forgotten
  std::vector<Known> known;
  const Known& find(const SiteMaps& maps, Index site, Index node) {
    Known& entry = known[SiteMaps::slot_of(site, node) % k_known];
    if (entry.round == round && entry.node == node && entry.site == site) return entry;
    entry.node = node;
    entry.site = site;
    entry.round = round;
    entry.found = maps.find(site, node, scratch, entry.vector);
    return entry;
  }
  /// Before others ask than the cells themselves.
  void forget() {
    scratch.forget();
    wishes.clear();
    ++round;
  }
};

/// Corners that neither the site nor a vertex of its cell sees: those of long faces that cells without vertices cross.
/// The first face that lays them decides, for all.
class CellClaims::Laid {
 public:
  Laid(const SiteMaps& maps, const JobStage& stage) : maps_(maps), stage_(stage) {}
  const PackedVec2* find(Index site, Index node) const {
    const auto found = corners_.find(pair_key(site, node));
    return found != corners_.end() ? &found->second : nullptr;
  }
  const PackedVec2& lay(Index site, Index node, const PackedVec2& corner) {
    return corners_.try_emplace(pair_key(site, node), corner).first->second;
  }
  /// The shortest way in the graph, as if it went on as it begins.
  PackedVec2 along_arcs(Index site, Index node);

 private:
  /// From one site; goes on from where it was.
  struct Search {
    struct Step {
      double distance;
      Index node;
      PackedVec2 towards;
      bool operator<(const Step& other) const {  // the nearest on top of a heap
        return distance != other.distance ? distance > other.distance : node > other.node;
      }
    };
    std::priority_queue<Step> queue;
    std::unordered_map<Index, PackedVec2> reached;
  };
  const SiteMaps& maps_;
  const JobStage& stage_;
  std::unordered_map<std::uint64_t, PackedVec2> corners_;
  std::unordered_map<Index, Search> searches_;  ///< by site
};

PackedVec2 CellClaims::Laid::along_arcs(Index site, Index node) {
  const auto [entry, is_new] = searches_.try_emplace(site);
  Search& search = entry->second;
  if (is_new)
    maps_.visit_seen(site, [&](Index seen, const PackedVec2& at) {
      search.queue.push({at.norm(), seen, at.norm() > 0 ? PackedVec2(at.normalized()) : PackedVec2(1, 0)});
    });
  const ArcRows& arcs = maps_.graph().arcs();
  while (!search.reached.contains(node)) {
    if (search.reached.size() % 64 == 0) stage_.check();
    const Search::Step step = search.queue.top();
    search.queue.pop();
    if (!search.reached.try_emplace(step.node, step.distance * step.towards).second) continue;
    for (std::int64_t arc = arcs.first(step.node); arc < arcs.first(step.node + 1); ++arc)
      if (const Index other = arcs.target(arc); !search.reached.contains(other))
        search.queue.push({step.distance + arcs.length(arc), other, step.towards});
  }
  return search.reached.at(node);
}

CellClaims::CellClaims(const SaddleVertexGraph& graph, const VertexRings& rings, CellLengths lengths, int threads,
                       int cuda_device)
    : graph_(graph), rings_(rings), threads_(threads), maps_(graph, rings, lengths, cuda_device) {
  for (int thread = 0; thread < thread_count(threads); ++thread) workers_.emplace_back(maps_);
}

CellClaims::~CellClaims() = default;

void CellClaims::find(const SurfacePoints& sites, const JobStage& stage) {
  if (!std::exchange(is_complete_, false)) {
    find_once(sites, {}, {}, stage);
  } else {
    find_once(sites, reaches(sites), sites_that_moved(sites), stage);
  }
  is_complete_ = true;
  // Where most sites move they move little; where few do, cells beside them may grow much.
  if (maps_.keeps_any()) look_farther(stage);
  stage.update(1);
}

void CellClaims::look_farther(const JobStage& stage) {
  std::vector<Index> sites;
  for (Index site = 0; site < site_count(); ++site)
    if (reach_[site] > maps_.limit(site)) sites.push_back(site);
  if (sites.empty()) return;
  is_complete_ = false;
  const std::vector<std::uint8_t> as_before = std::move(is_as_before_);
  const std::vector<double> without_end(site_count(), std::numeric_limits<double>::infinity());
  find_once(SurfacePoints(maps_.sites()), without_end, std::move(sites), JobStage(stage));
  for (Index site = 0; site < site_count(); ++site) is_as_before_[site] &= as_before[site];
  is_complete_ = true;
}

/// `others` as for SiteMaps.
void CellClaims::find_once(const SurfacePoints& sites, std::span<const double> reaches,
                           const std::optional<std::vector<Index>>& others, const JobStage& stage) {
  maps_.label_nodes(sites, reaches, others, threads_, stage.part(0, 0.6));
  if (maps_.keeps_any()) remember();
  reach_.resize(site_count());
  has_laid_.resize(site_count());
  is_kept_.resize(site_count());
  for (Index site = 0; site < site_count(); ++site) {
    const bool had_laid = std::exchange(has_laid_[site], 0) != 0;
    is_kept_[site] = maps_.is_kept(site) && !had_laid;
    if (!is_kept(site)) reach_[site] = 0;
  }
  find_mixed_faces();
  claim_by_cells(stage);
  if (maps_.keeps_any()) keep_claims();
  stage.update(0.85);
  spread(sites, stage);
  compare();
}

std::vector<Index> CellClaims::sites_that_moved(const SurfacePoints& sites) const {
  std::vector<Index> moved;
  for (Index site = 0; site < static_cast<Index>(sites.size()); ++site) {
    const bool stays = site < site_count() && maps_.sites()[site].face == sites[site].face &&
                       maps_.sites()[site].barycentric == sites[site].barycentric;
    if (!stays) moved.push_back(site);
  }
  return moved;
}

/// How far sites may own something: as far as before, and as they have moved.
std::vector<double> CellClaims::reaches(const SurfacePoints& sites) const {
  const Mesh& mesh = graph_.mesh();
  std::vector<double> reaches(sites.size(), std::numeric_limits<double>::infinity());
  parallel_for(site_count(), threads_, 128, [&](Index i, int) {
    const Index site = maps_.sites_along_curve()[i];
    if (site >= static_cast<Index>(sites.size()) || !(reach_[site] > 0)) return;
    reaches[site] = reach_[site] + (position(mesh, sites[site]) - position(mesh, maps_.sites()[site])).norm();
  });
  return reaches;
}

/// The claims of kept cells are looked up; all others are made anew.
void CellClaims::remember() {
  before_.shared_index.swap(shared_index_);
  before_.rows.swap(rows_);
  before_.claims.swap(claims_);
}

void CellClaims::renumber(std::span<const Index> before) {
  std::vector<Index> now(site_count(), k_none);
  std::vector<double> reach(before.size(), 0);
  std::vector<std::uint8_t> has_laid(before.size(), 0);
  for (Index site = 0; site < static_cast<Index>(before.size()); ++site) {
    const Index old = before[site];
    if (old == k_none) continue;
    now[old] = site;
    reach[site] = reach_[old];
    has_laid[site] = has_laid_[old];
  }
  for (CellClaim& claim : claims_) {
    if (claim.site != k_none) claim.site = now[claim.site];
  }
  reach_.swap(reach);
  has_laid_.swap(has_laid);
  maps_.renumber(before);
}

CellClaims::Stretch CellClaims::shared_within(Index first_face, Index end_face) const {
  const auto mixed_end = rows_.begin() + mixed_count_;
  const auto below = [](const Row& row, Index face) { return row.face < face; };
  const auto number = [&](auto begin, auto end, Index face) {
    return static_cast<Index>(std::lower_bound(begin, end, face, below) - rows_.begin());
  };
  return {number(rows_.begin(), mixed_end, first_face), number(rows_.begin(), mixed_end, end_face),
          number(mixed_end, rows_.end(), first_face), number(mixed_end, rows_.end(), end_face)};
}

/// Faces whose corners differ in their labels, each with room for as many claims as there are labels.
void CellClaims::find_mixed_faces() {
  constexpr Index k_stretch = 4096;
  const Index count = rings_.face_count(), stretches = (count + k_stretch - 1) / k_stretch;
  struct Sum {
    Index rows = 0, claims = 0;
  };
  std::vector<Sum> sums(stretches);
  shared_index_.resize(count);
  const auto in_stretches = [&](auto&& visit) {
    parallel_for(stretches, threads_, 1, [&](Index stretch, int) {
      Sum sum = sums[stretch];  // not counted where the other threads' are
      for (Index face = stretch * k_stretch; face < std::min(count, (stretch + 1) * k_stretch); ++face)
        visit(face, sum);
      sums[stretch] = sum;
    });
  };
  in_stretches([&](Index face, Sum& sum) {
    const auto& nodes = rings_.face(face).nodes;
    const Index a = maps_.label(nodes[0]), b = maps_.label(nodes[1]), c = maps_.label(nodes[2]);
    const Index labels = a == b && b == c ? 1 : a != b && b != c && c != a ? 3 : 2;
    shared_index_[face] = labels;
    sum.rows += labels > 1;
    sum.claims += labels > 1 ? labels : 0;
  });
  Sum all;
  for (Sum& sum : sums) {
    std::swap(sum, all);
    all = {all.rows + sum.rows, all.claims + sum.claims};
  }
  rows_.resize(all.rows);
  mixed_count_ = all.rows;
  at_border_.assign(graph_.mesh().vertex_count(), 0);
  in_stretches([&](Index face, Sum& next) {
    const Index labels = std::exchange(shared_index_[face], k_none);
    if (labels == 1) return;
    shared_index_[face] = next.rows;
    rows_[next.rows++] = {face, next.claims, labels};
    next.claims += labels;
    mark_border(face);
  });
  constexpr Index k_late_share = 8;  // one late claim for so many others there is room for
  if (claims_.capacity() < static_cast<std::size_t>(all.claims))
    claims_.reserve(all.claims + all.claims / k_late_share);
  claims_.resize(all.claims);
}

/// Each label of a face's corners claims it where they differ; cell by cell, whose own vertices and those beside it
/// are in reach then.
void CellClaims::claim_by_cells(const JobStage& stage) {
  for (Worker& worker : workers_) worker.forget();
  constexpr Index k_chunk = 4;
  parallel_for(site_count(), threads_, k_chunk, [&](Index i, int thread) {
    stage.check();
    const Index site = maps_.sites_along_curve()[i];
    const bool goes_on = (i + 1) % k_chunk != 0 && i + 1 < site_count();  // else another thread may place the next
    if (goes_on) maps_.fetch_cell(maps_.sites_along_curve()[i + 1]);
    if (is_kept(site)) return;
    maps_.place_cell(site, workers_[thread].scratch);
    for (const Index node : maps_.nodes(site))
      if (is_at_border(node)) reach_[site] = std::max(reach_[site], claim_from(node, site, workers_[thread]));
  });
}

/// The claims of kept cells on faces whose corners' labels differ.
void CellClaims::keep_claims() {
  parallel_for(mixed_count_, threads_, 512, [&](Index shared, int) {
    const Row& row = rows_[shared];
    std::array<Index, 3> labels;
    std::ranges::transform(rings_.face(row.face).nodes, labels.begin(), [&](Index node) { return maps_.label(node); });
    std::ranges::sort(labels);
    const auto rest = std::ranges::unique(labels);
    CellClaim* claim = &claims_[row.first];
    for (auto label = labels.begin(); label != rest.begin(); ++label, ++claim)
      if (is_kept(*label)) *claim = *kept_claim(row.face, *label);
  });
}

/// Null where there is none.
const CellClaim* CellClaims::kept_claim(Index face, Index site) const {
  if (!is_kept(site)) return nullptr;
  const auto claims = before_.on(face);
  const auto found = std::ranges::find(claims, site, &CellClaim::site);
  return found != claims.end() ? &*found : nullptr;
}

/// Which cells have the parts of faces that they had.
void CellClaims::compare() {
  is_as_before_.assign(site_count(), maps_.keeps_any());
  if (!maps_.keeps_any()) return;
  const auto differ = [&](std::span<const CellClaim> claims) {
    for (const CellClaim& claim : claims)
      if (claim.site != k_none) std::atomic_ref(is_as_before_[claim.site]).store(0, std::memory_order_relaxed);
  };
  for (Index site = 0; site < site_count(); ++site)
    if (!is_kept(site)) is_as_before_[site] = 0;
  parallel_for(shared_count(), threads_, 512, [&](Index shared, int) {
    const auto now = claims(shared), then = before_.on(face(shared));
    const auto same = [&](const CellClaim& a, const CellClaim& b) { return a.site == b.site && is_kept(a.site); };
    if (std::ranges::equal(now, then, same)) return;
    differ(now);
    differ(then);
  });
  parallel_for(static_cast<Index>(before_.rows.size()), threads_, 512, [&](Index row, int) {
    const Index face = before_.rows[row].face;
    if (shared_index_[face] == k_none) differ(before_.on(face));
  });
}

/// The faces about a node that are shared and have no earlier node of the cell's. How far the site sees their corners.
double CellClaims::claim_from(Index node, Index site, Worker& worker) {
  const SiteVector own = maps_.own(node);
  double farthest = own.distance;
  Index last = k_none;  // the wedge before ends where this one begins
  SiteVector at_last;
  for (const VertexRings::Wedge& wedge : rings_.around(node)) {
    const Index from = maps_.label(wedge.from), to = maps_.label(wedge.to);
    if ((from == site && (to == site || wedge.from < node)) || (to == site && wedge.to < node)) continue;
    const Index face = wedge.side / 3, start = wedge.side % 3;
    const Row& row = rows_[shared_index_[face]];
    CellClaim& claim = claims_[row.first + (from < site) + (to < site && to != from)];
    claim.face = face;
    claim.site = site;
    if (wedge.from != last) maps_.find(site, wedge.from, worker.scratch, at_last);  // each is beside the cell
    claim.corner[start] = at_last.log;
    farthest = std::max(farthest, at_last.distance);
    last = wedge.to;
    maps_.find(site, last, worker.scratch, at_last);
    claim.corner[Mesh::next(start)] = at_last.log;
    claim.corner[Mesh::prev(start)] = own.log;
    farthest = std::max(farthest, at_last.distance);
  }
  return farthest;
}

/// May be called by several threads at once.
void CellClaims::reach_corners(const CellClaim& claim) {
  const double farthest =
      std::sqrt(std::max({claim.squared_distance(0), claim.squared_distance(1), claim.squared_distance(2)}));
  const std::atomic_ref reach(reach_[claim.site]);
  for (double before = reach.load(std::memory_order_relaxed); before < farthest;)
    if (reach.compare_exchange_weak(before, farthest, std::memory_order_relaxed)) break;
}

/// May be called by several threads at once.
void CellClaims::mark_border(Index face) {
  for (const Index node : rings_.face(face).nodes)
    std::atomic_ref(at_border_[node]).store(1, std::memory_order_relaxed);
}

/// Claims of sites on the faces in which they lie.
void CellClaims::find_wishes_of_sites(const SurfacePoints& sites) {
  parallel_for(site_count(), threads_, 256, [&](Index i, int thread) {
    const Index site = maps_.sites_along_curve()[i];
    wish_for({rings_.face_of(sites[site].face), site, k_none}, workers_[thread].wishes);
  });
}

/// False where corners are left to be laid down.
bool CellClaims::make_claim(Index face, Index site, const Laid& laid, Worker& worker, CellClaim& claim) const {
  if (const CellClaim* const kept = kept_claim(face, site)) {
    claim = *kept;
    return true;
  }
  const auto& nodes = rings_.face(face).nodes;
  claim = {face, site, {}};
  bool complete = true;
  for (int i = 0; i < 3; ++i) {
    const Worker::Known& known = worker.find(maps_, site, nodes[i]);
    claim.corner[i] = known.vector.log;
    if (known.found) continue;
    if (const PackedVec2* const found = laid.find(site, nodes[i]))
      claim.corner[i] = *found;
    else
      claim.corner[i].setConstant(k_unknown), complete = false;
  }
  return complete;
}

/// Completes a claim: by what is seen across the side, else along arcs.
void CellClaims::lay_corners(Index side, Laid& laid, CellClaim& claim) const {
  constexpr double k_bent = 3e-2;  // how much ways may differ from what is seen where lengths are smooth
  const auto& nodes = rings_.face(claim.face).nodes;
  const auto lay = [&](int corner, const std::optional<PackedVec2>& seen) {
    if (!is_unknown(claim.corner[corner])) return;
    const Index node = nodes[corner];
    PackedVec2 place = seen && !maps_.is_smooth() ? *seen : laid.along_arcs(claim.site, node);
    if (seen && std::abs(seen->norm() - place.norm()) <= k_bent * place.norm()) place = *seen;
    claim.corner[corner] = laid.lay(claim.site, node, place);
  };
  const int apex = side == k_none ? 2 : Mesh::prev(side) % 3, start = Mesh::next(apex), end = Mesh::prev(apex);
  lay(start, {});
  lay(end, {});
  lay(apex,
      side == k_none ? std::nullopt : maps_.seen_beyond(rings_.halfedge(side), claim.corner[start], claim.corner[end]));
}

/// No site is nearer to a vertex than that of its label: which one is, the graph says, unless lengths are smooth.
void CellClaims::yield_to_labels(CellClaim& claim) {
  if (maps_.is_smooth()) return;
  constexpr double k_farther = 1 + 4 * std::numeric_limits<double>::epsilon();
  const auto& nodes = rings_.face(claim.face).nodes;
  for (int i = 0; i < 3; ++i) {
    const Index label = maps_.label(nodes[i]);
    if (label == claim.site) continue;
    const double own = claim.squared_distance(i), least = maps_.own(nodes[i]).log.squaredNorm();
    if (own > least || (own == least && label < claim.site)) continue;
    claim.corner[i] = std::sqrt(least) * k_farther * claim.corner[i].normalized();
    std::atomic_ref(has_laid_[claim.site]).store(1, std::memory_order_relaxed);
  }
}

/// Makes the claims that are wished for; each face and site once.
void CellClaims::grant(const std::vector<Wish>& wishes, Laid& laid) {
  const auto count = static_cast<Index>(wishes.size()), first = static_cast<Index>(late_.size());
  std::vector<std::uint8_t> complete(count);
  late_.resize(first + count);
  parallel_for(count, threads_, 32, [&](Index i, int thread) {
    CellClaim& claim = late_[first + i].claim;
    complete[i] = make_claim(wishes[i].face, wishes[i].site, laid, workers_[thread], claim);
    if (!complete[i]) return;
    yield_to_labels(claim);
    reach_corners(claim);
  });
  for (Index i = 0; i < count; ++i) {
    if (complete[i]) continue;
    CellClaim& claim = late_[first + i].claim;
    has_laid_[claim.site] = 1;
    lay_corners(wishes[i].side, laid, claim);
    yield_to_labels(claim);
    reach_corners(claim);
  }
  const auto known = std::ssize(late_faces_);
  for (Index i = 0; i < count; ++i) {  // found from their faces only now, when all are complete
    Index& last = late_index_[wishes[i].face];
    if (last == k_none) late_faces_.push_back(wishes[i].face);
    late_[first + i].before = std::exchange(last, first + i);
  }
  std::inplace_merge(late_faces_.begin(), late_faces_.begin() + known, late_faces_.end());
}

void CellClaims::forget_late() {
  if (late_index_.empty()) late_index_.assign(rings_.face_count(), k_none);
  for (const Index face : late_faces_) late_index_[face] = k_none;
  late_faces_.clear();
  late_.clear();
  first_fresh_ = 0;
}

/// The workers', in order, each face and site once.
std::vector<CellClaims::Wish> CellClaims::all_wishes() {
  const auto same = [](const Wish& a, const Wish& b) { return a.face == b.face && a.site == b.site; };
  constexpr std::size_t k_worth_threads = 4096;  // where cells spread through long faces there are many rounds of few
  const auto count = static_cast<Index>(workers_.size());
  std::size_t wish_count = 0;
  for (const Worker& worker : workers_) wish_count += worker.wishes.size();
  const int threads = wish_count < k_worth_threads ? 1 : threads_;
  parallel_for(count, threads, 1, [&](Index i, int) { std::ranges::sort(workers_[i].wishes); });
  for (Index step = 1; step < count; step *= 2) {
    parallel_for((count - step + 2 * step - 1) / (2 * step), threads, 1, [&](Index pair, int) {
      std::vector<Wish>&a = workers_[2 * step * pair].wishes, &b = workers_[2 * step * pair + step].wishes;
      const auto middle = std::ssize(a);
      a.insert(a.end(), b.begin(), b.end());
      std::ranges::inplace_merge(a, a.begin() + middle);
      b.clear();
    });
  }
  std::vector<Wish> wishes = std::exchange(workers_.front().wishes, {});
  const auto rest = std::ranges::unique(wishes, same);
  wishes.erase(rest.begin(), rest.end());
  return wishes;
}

/// Claims beyond the edges of faces with new claims, until there are no new ones.
void CellClaims::spread(const SurfacePoints& sites, const JobStage& stage) {
  forget_late();
  for (Worker& worker : workers_) worker.forget();
  find_wishes_of_sites(sites);
  Laid laid(maps_, stage);
  std::vector<Index> changed;  // empty: all shared faces
  while (true) {
    const auto count = static_cast<Index>(changed.empty() ? rows_.size() : changed.size());
    parallel_for(count, threads_, 128, [&](Index i, int thread) {
      stage.check();
      const Index face = changed.empty() ? rows_[i].face : changed[i];
      if (is_settled(face)) return;
      if (changed.empty())
        for (CellClaim& claim : claims_of(rows_[i])) yield_to_labels(claim);
      if (!is_settled(face)) find_wishes(face, workers_[thread]);
    });
    const std::vector<Wish> wishes = all_wishes();
    if (wishes.empty()) break;
    first_fresh_ = static_cast<Index>(late_.size());
    grant(wishes, laid);
    changed.clear();
    for (const Wish& wish : wishes) {
      if (changed.empty() || changed.back() != wish.face) changed.push_back(wish.face);
    }
  }
  merge_late();
}

/// Faces with late claims get new rows behind the others.
void CellClaims::merge_late() {
  Index end = claim_count();
  std::vector<Row> late_rows(late_faces_.size());
  parallel_for(static_cast<Index>(late_rows.size()), threads_, 256, [&](Index i, int) {
    Row& row = late_rows[i] = {late_faces_[i], 0, 0};
    visit_claims(row.face, [&](const CellClaim&) { ++row.count; });
  });
  for (Row& row : late_rows) end += row.count, row.first = end - row.count;
  claims_.resize(end);
  parallel_for(static_cast<Index>(late_rows.size()), threads_, 64, [&](Index i, int) {
    CellClaim* const row = claims_.data() + late_rows[i].first;
    CellClaim* next = row;
    visit_claims(late_rows[i].face, [&](const CellClaim& claim) { *next++ = claim; });
    std::sort(row, next, [](const CellClaim& a, const CellClaim& b) { return a.site < b.site; });
  });
  for (const Row& row : late_rows) {
    Index& shared = shared_index_[row.face];
    if (shared == k_none) {
      shared = shared_count();
      rows_.emplace_back();
      mark_border(row.face);
    }
    rows_[shared] = row;
  }
}

template <class Visit>
void CellClaims::visit_claims(Index face, Visit&& visit) const {
  if (shared_index_[face] != k_none) {
    for (const CellClaim& claim : claims(shared_index_[face])) visit(claim);
  }
  for (Index i = late_index_[face]; i != k_none; i = late_[i].before) visit(late_[i].claim);
}

/// Whether each corner is nearest to its label, which claims the faces beyond, and no third site is nearest, or nearly
/// so, between corners.
bool CellClaims::is_settled(Index face) const {
  constexpr double k_margin = 1e-9;  // of squared distances
  if (late_index_[face] != k_none) return false;
  const auto all = claims(shared_index_[face]);
  const auto& nodes = rings_.face(face).nodes;
  std::array<const CellClaim*, 3> nearest;
  for (int i = 0; i < 3; ++i) {
    nearest[i] = all.data();
    for (const CellClaim& claim : all)
      if (claim.squared_distance(i) < nearest[i]->squared_distance(i)) nearest[i] = &claim;
    if (nearest[i]->site != maps_.label(nodes[i])) return false;
  }
  if (all.size() == 2) return true;
  for (int i = 0; i < 3; ++i) {
    const int end = (i + 1) % 3;
    const CellClaim &a = *nearest[i], &b = *nearest[end];
    const double at_start = b.squared_distance(i) - a.squared_distance(i),
                 at_end = a.squared_distance(end) - b.squared_distance(end);
    const double t = &a == &b ? 0 : at_start / (at_start + at_end);
    const double nearer = (1 - t) * a.squared_distance(i) + t * a.squared_distance(end);
    for (const CellClaim& other : all) {
      if (&other == &a || &other == &b) continue;
      const double value = (1 - t) * other.squared_distance(i) + t * other.squared_distance(end);
      if (!(value > (1 + k_margin) * nearer)) return false;
    }
  }
  return true;
}

/// Of the sites whose claims are new: others have wished for what they win here before, and have not won more since.
void CellClaims::find_wishes(Index face, Worker& worker) const {
  worker.claims.clear();
  worker.fresh.clear();
  visit_claims(face, [&](const CellClaim& claim) { worker.claims.push_back(&claim); });
  for (Index i = late_index_[face]; i != k_none && i >= first_fresh_; i = late_[i].before)
    worker.fresh.push_back(late_[i].claim.site);
  const VertexRings::Face& here = rings_.face(face);
  for (Index side = 3 * face; side < 3 * face + 3; ++side) {
    const Index twin = here.twins[side % 3];
    if (twin == k_none) continue;
    // The labels of the edge's ends have claims beyond it.
    const Index at_start = maps_.label(here.nodes[side % 3]), at_end = maps_.label(here.nodes[Mesh::next(side) % 3]);
    const auto wish = [&](Index site) {
      if (site == at_start || site == at_end) return;
      const bool is_fresh = first_fresh_ == 0 || std::ranges::find(worker.fresh, site) != worker.fresh.end();
      if (is_fresh) wish_for({twin / 3, site, twin}, worker.wishes);
    };
    worker.lines.clear();
    for (const CellClaim* claim : worker.claims) worker.lines.push_back(claim->line_along(side));
    if (worker.lines.size() == 2) {
      for (const Index site : winners(worker.lines[0], worker.lines[1])) wish(site);
      continue;
    }
    lower_envelope(worker.lines, worker.pieces);
    for (const EdgePiece& piece : worker.pieces) wish(piece.site);
  }
}

bool CellClaims::is_claimed(Index face, Index site) const {
  for (Index i = late_index_[face]; i != k_none; i = late_[i].before)
    if (late_[i].claim.site == site) return true;
  const Index shared = shared_index_[face];
  return shared != k_none && std::ranges::find(claims(shared), site, &CellClaim::site) != claims(shared).end();
}

/// A claim on the face unless it is there; on a face that one cell owned so far, one of that cell, too.
void CellClaims::wish_for(const Wish& wish, std::vector<Wish>& wishes) const {
  const bool shared = shared_index_[wish.face] != k_none || late_index_[wish.face] != k_none;
  if (shared ? is_claimed(wish.face, wish.site) : face_site(wish.face) == wish.site) return;
  if (!shared) wishes.push_back({wish.face, face_site(wish.face), k_none});
  wishes.push_back(wish);
}

}  // namespace saddleback
