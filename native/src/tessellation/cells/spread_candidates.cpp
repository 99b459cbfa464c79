#include "tessellation/cells/spread_candidates.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "support/threads/parallel.h"
#include "tessellation/cells/extrapolated_corners.h"

namespace saddleback {
namespace {

/// Tells the nearest of two sites at an edge's start and at its end, as lower_envelope tells them.
std::array<Index, 2> winners(const EdgeLine& a, const EdgeLine& b) {
  const auto nearer = [&](double of_a, double of_b) {
    return of_a != of_b ? (of_a < of_b ? a.site : b.site) : std::min(a.site, b.site);
  };
  return {nearer(a.at_start, b.at_start), nearer(a.at_end, b.at_end)};
}

}  // namespace

void CornersOfSites::add(const CellCandidate& candidate) {
  const double most = std::sqrt(
      std::max({candidate.squared_distance(0), candidate.squared_distance(1), candidate.squared_distance(2)}));
  const std::atomic_ref known(farthest[candidate.site]);
  for (double before = known.load(std::memory_order_relaxed); before < most;)
    if (known.compare_exchange_weak(before, most, std::memory_order_relaxed)) break;
}

void CornersOfSites::mark_extrapolated(Index site) {
  std::atomic_ref(is_extrapolated[site]).store(1, std::memory_order_relaxed);
}

const CellCandidate* CellsBefore::find(Index face, Index site) const {
  if (!keeps(site)) return nullptr;
  const auto candidates = rows.on(face);
  const auto found = std::ranges::find(candidates, site, &CellCandidate::site);
  return found != candidates.end() ? &*found : nullptr;
}

/// A thread's own memory.
struct alignas(k_apart) CandidateSpread::Worker {
  explicit Worker(VerticesBeside& vertices) : beside(vertices), known(k_known) {}
  VerticesBeside& beside;
  std::vector<Request> requests;
  std::vector<const CellCandidate*> candidates;
  std::vector<Index> newest;
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
  const Known& find(Index site, Index node) {
    Known& entry = known[VerticesBeside::slot_of(site, node) % k_known];
    if (entry.round == round && entry.node == node && entry.site == site) return entry;
    entry.node = node;
    entry.site = site;
    entry.round = round;
    entry.found = beside.find(site, node, entry.vector);
    return entry;
  }
  void forget() {
    beside.forget();
    requests.clear();
    ++round;
  }
};

CandidateSpread::CandidateSpread(const CellLogMaps& maps, std::vector<VerticesBeside>& beside, int threads)
    : maps_(maps), rings_(maps.rings()), threads_(threads), last_added_(maps.rings().face_count(), k_none) {
  for (VerticesBeside& vertices : beside) workers_.emplace_back(vertices);
}

CandidateSpread::~CandidateSpread() = default;

void CandidateSpread::run(const SurfacePoints& sites, const CellsBefore& before, CandidateRows& rows,
                          CornersOfSites& corners, const JobStage& stage) {
  const Ground ground{before, rows, corners};
  begin(sites, ground);
  ExtrapolatedCorners extrapolated(maps_, stage);
  std::vector<Index> changed;  // empty: all shared faces
  while (true) {
    const Index count = changed.empty() ? rows.shared_count() : static_cast<Index>(changed.size());
    parallel_for(count, threads_, 128, [&](Index i, int thread) {
      stage.check();
      const Index face = changed.empty() ? rows.face(i) : changed[i];
      if (is_settled(face, rows)) return;
      if (changed.empty())
        for (CellCandidate& candidate : rows.candidates(i)) yield_to_labels(candidate, corners);
      if (!is_settled(face, rows)) find_requests(face, rows, workers_[thread]);
    });
    const std::vector<Request> requests = all_requests();
    if (requests.empty()) break;
    first_newest_ = static_cast<Index>(added_.size());
    add(requests, ground, extrapolated);
    changed.clear();
    for (const Request& request : requests) {
      if (changed.empty() || changed.back() != request.face) changed.push_back(request.face);
    }
  }
  merge_added(rows);
}

/// Forgets the last ones, and requests sites for the faces in which they lie.
void CandidateSpread::begin(const SurfacePoints& sites, const Ground& ground) {
  for (const Index face : added_faces_) last_added_[face] = k_none;
  added_faces_.clear();
  added_.clear();
  first_newest_ = 0;
  for (Worker& worker : workers_) worker.forget();
  const SiteLabels& labels = maps_.labels();
  parallel_for(labels.site_count(), threads_, 256, [&](Index i, int thread) {
    const Index site = labels.sites_along_curve()[i];
    request({rings_.face_of(sites[site].face), site, k_none}, ground.rows, workers_[thread].requests);
  });
}

/// Makes a candidate. False where corners are left to be extrapolated.
bool CandidateSpread::make(const Request& request, const Ground& ground, const ExtrapolatedCorners& corners,
                           Worker& worker, CellCandidate& candidate) const {
  const auto [face, site, side] = request;
  if (const CellCandidate* const kept = ground.before.find(face, site)) {
    candidate = *kept;
    return true;
  }
  const auto& nodes = rings_.face(face).nodes;
  candidate = {face, site, {}};
  bool complete = true;
  for (int i = 0; i < 3; ++i) {
    const Worker::Known& known = worker.find(site, nodes[i]);
    candidate.corner[i] = known.vector.log;
    if (known.found) continue;
    if (const PackedVec2* const found = corners.find(site, nodes[i]))
      candidate.corner[i] = *found;
    else
      candidate.corner[i].setConstant(ExtrapolatedCorners::k_unknown), complete = false;
  }
  return complete;
}

/// Lets no site be nearer to a vertex than that of its label: which one is, the graph says, unless lengths are smooth.
void CandidateSpread::yield_to_labels(CellCandidate& candidate, CornersOfSites& corners) const {
  if (maps_.is_smooth()) return;
  constexpr double k_farther = 1 + 4 * std::numeric_limits<double>::epsilon();
  const auto& nodes = rings_.face(candidate.face).nodes;
  for (int i = 0; i < 3; ++i) {
    const Index label = maps_.labels().label(nodes[i]);
    if (label == candidate.site) continue;
    const double own = candidate.squared_distance(i), least = maps_.own(nodes[i]).log.squaredNorm();
    if (own > least || (own == least && label < candidate.site)) continue;
    candidate.corner[i] = std::sqrt(least) * k_farther * candidate.corner[i].normalized();
    corners.mark_extrapolated(candidate.site);
  }
}

/// Adds the candidates that are requested; each face and site once.
void CandidateSpread::add(const std::vector<Request>& requests, const Ground& ground, ExtrapolatedCorners& corners) {
  const auto count = static_cast<Index>(requests.size()), first = static_cast<Index>(added_.size());
  std::vector<std::uint8_t> complete(count);
  added_.resize(first + count);
  const auto take_in = [&](CellCandidate& candidate) {
    yield_to_labels(candidate, ground.corners);
    ground.corners.add(candidate);
  };
  parallel_for(count, threads_, 32, [&](Index i, int thread) {
    CellCandidate& candidate = added_[first + i].candidate;
    complete[i] = make(requests[i], ground, corners, workers_[thread], candidate);
    if (complete[i]) take_in(candidate);
  });
  for (Index i = 0; i < count; ++i) {
    if (complete[i]) continue;
    CellCandidate& candidate = added_[first + i].candidate;
    ground.corners.mark_extrapolated(candidate.site);
    corners.complete(candidate, requests[i].side);
    take_in(candidate);
  }
  const auto known = std::ssize(added_faces_);
  for (Index i = 0; i < count; ++i) {  // found from their faces only now, when all are complete
    Index& last = last_added_[requests[i].face];
    if (last == k_none) added_faces_.push_back(requests[i].face);
    added_[first + i].before = std::exchange(last, first + i);
  }
  std::inplace_merge(added_faces_.begin(), added_faces_.begin() + known, added_faces_.end());
}

/// Joins the workers' requests in order, each face and site once.
std::vector<CandidateSpread::Request> CandidateSpread::all_requests() {
  const auto same = [](const Request& a, const Request& b) { return a.face == b.face && a.site == b.site; };
  constexpr std::size_t k_worth_threads = 4096;  // where cells spread through long faces there are many rounds of few
  const auto count = static_cast<Index>(workers_.size());
  std::size_t request_count = 0;
  for (const Worker& worker : workers_) request_count += worker.requests.size();
  const int threads = request_count < k_worth_threads ? 1 : threads_;
  parallel_for(count, threads, 1, [&](Index i, int) { std::ranges::sort(workers_[i].requests); });
  for (Index step = 1; step < count; step *= 2) {
    parallel_for((count - step + 2 * step - 1) / (2 * step), threads, 1, [&](Index pair, int) {
      std::vector<Request>&a = workers_[2 * step * pair].requests, &b = workers_[2 * step * pair + step].requests;
      const auto middle = std::ssize(a);
      a.insert(a.end(), b.begin(), b.end());
      std::ranges::inplace_merge(a, a.begin() + middle);
      b.clear();
    });
  }
  std::vector<Request> requests = std::exchange(workers_.front().requests, {});
  const auto rest = std::ranges::unique(requests, same);
  requests.erase(rest.begin(), rest.end());
  return requests;
}

/// Gives faces with added candidates new rows behind the others.
void CandidateSpread::merge_added(CandidateRows& rows) {
  const auto count = static_cast<Index>(added_faces_.size());
  std::vector<CandidateRows::Row> added(count);
  parallel_for(count, threads_, 256, [&](Index i, int) {
    added[i] = {added_faces_[i], 0, 0};
    visit(added_faces_[i], rows, [&](const CellCandidate&) { ++added[i].count; });
  });
  rows.make_room(added);
  parallel_for(count, threads_, 64, [&](Index i, int) {
    const std::span<CellCandidate> row = rows.of(added[i]);
    auto next = row.begin();
    visit(added_faces_[i], rows, [&](const CellCandidate& candidate) { *next++ = candidate; });
    std::ranges::sort(row, {}, &CellCandidate::site);
  });
  rows.add(added);
}

template <class Visit>
void CandidateSpread::visit(Index face, const CandidateRows& rows, Visit&& visit) const {
  for (const CellCandidate& candidate : rows.on(face)) visit(candidate);
  for (Index i = last_added_[face]; i != k_none; i = added_[i].before) visit(added_[i].candidate);
}

/// Tells whether each corner is nearest to its label, which is a candidate of the faces beyond, and no third site is
/// nearest, or nearly so, between corners.
bool CandidateSpread::is_settled(Index face, const CandidateRows& rows) const {
  constexpr double k_margin = 1e-9;  // of squared distances
  if (last_added_[face] != k_none) return false;
  const auto all = rows.candidates(rows.shared_index(face));
  const auto& nodes = rings_.face(face).nodes;
  std::array<const CellCandidate*, 3> nearest;
  for (int i = 0; i < 3; ++i) {
    nearest[i] = all.data();
    for (const CellCandidate& candidate : all)
      if (candidate.squared_distance(i) < nearest[i]->squared_distance(i)) nearest[i] = &candidate;
    if (nearest[i]->site != maps_.labels().label(nodes[i])) return false;
  }
  if (all.size() == 2) return true;
  for (int i = 0; i < 3; ++i) {
    const int end = (i + 1) % 3;
    const CellCandidate &a = *nearest[i], &b = *nearest[end];
    const double at_start = b.squared_distance(i) - a.squared_distance(i),
                 at_end = a.squared_distance(end) - b.squared_distance(end);
    const double t = &a == &b ? 0 : at_start / (at_start + at_end);
    const double nearer = (1 - t) * a.squared_distance(i) + t * a.squared_distance(end);
    for (const CellCandidate& other : all) {
      if (&other == &a || &other == &b) continue;
      const double value = (1 - t) * other.squared_distance(i) + t * other.squared_distance(end);
      if (!(value > (1 + k_margin) * nearer)) return false;
    }
  }
  return true;
}

/// Requests what the newest sites win beyond the face: others have requested what they win here before, and have not
/// won more since.
void CandidateSpread::find_requests(Index face, const CandidateRows& rows, Worker& worker) const {
  worker.candidates.clear();
  worker.newest.clear();
  visit(face, rows, [&](const CellCandidate& candidate) { worker.candidates.push_back(&candidate); });
  for (Index i = last_added_[face]; i != k_none && i >= first_newest_; i = added_[i].before)
    worker.newest.push_back(added_[i].candidate.site);
  const VertexRings::Face& here = rings_.face(face);
  for (Index side = 3 * face; side < 3 * face + 3; ++side) {
    const Index twin = here.twins[side % 3];
    if (twin == k_none) continue;
    // The labels of the edge's ends are candidates beyond it.
    const Index at_start = maps_.labels().label(here.nodes[side % 3]),
                at_end = maps_.labels().label(here.nodes[Mesh::next(side) % 3]);
    const auto want = [&](Index site) {
      if (site == at_start || site == at_end) return;
      const bool is_newest = first_newest_ == 0 || std::ranges::find(worker.newest, site) != worker.newest.end();
      if (is_newest) request({twin / 3, site, twin}, rows, worker.requests);
    };
    worker.lines.clear();
    for (const CellCandidate* candidate : worker.candidates) worker.lines.push_back(candidate->line_along(side));
    if (worker.lines.size() == 2) {
      for (const Index site : winners(worker.lines[0], worker.lines[1])) want(site);
      continue;
    }
    lower_envelope(worker.lines, worker.pieces);
    for (const EdgePiece& piece : worker.pieces) want(piece.site);
  }
}

/// Requests a candidate for a face unless it is there; for a face that one cell owned so far, that cell's site, too.
void CandidateSpread::request(const Request& request, const CandidateRows& rows, std::vector<Request>& requests) const {
  const auto [face, site, side] = request;
  const Index owner = maps_.labels().label(rings_.face(face).nodes[0]);
  if (rows.shared_index(face) != k_none || last_added_[face] != k_none) {
    bool is_there = false;
    visit(face, rows, [&](const CellCandidate& candidate) { is_there = is_there || candidate.site == site; });
    if (is_there) return;
  } else {
    if (owner == site) return;
    requests.push_back({face, owner, k_none});
  }
  requests.push_back(request);
}

}  // namespace saddleback
