// Candidates are taken in batches: all of a batch are tested against what insert there before it, by all threads, then
// committed in order. One that shares a face with another of its batch that was committed before it is tested again. So
// each is laid exactly if it has room among those before it. Batches depend on nothing but the outcomes.

#include "distribution/insertion.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "saddleback/error.h"

#include "support/key_order.h"
#include "support/threads/parallel.h"

namespace saddleback::distribution {
namespace {

constexpr std::size_t k_least_batch = 8, k_first_batch = 64, k_largest_batch = 4096;
constexpr Index k_sorted_at_once = 1 << 14;
/// Candidates that a thread takes at a time: fewer are not worth waking it up for.
constexpr Index k_share = 8;

Outcome outcome_of(MapFailure failure) {
  switch (failure) {
    case MapFailure::boundary:
      return Outcome::boundary;
    case MapFailure::fold:
      return Outcome::fold;
    case MapFailure::stretched:
      return Outcome::stretched;
    default:
      return Outcome::laid;
  }
}

const char* reason_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::collision:
      return " meets one before it; leave one of them out";
    case Outcome::boundary:
      return " reaches beyond the boundary of the surface; leave it out";
    case Outcome::forbidden:
      return " lies on a forbidden face; leave it out";
    default:
      return " cannot be laid where it is, as the surface bends too much; leave it out";
  }
}

/// Allows as many candidates in vain as fall on the area of a copy without a gap. With a gap much wider than the shapes
/// they would be thousands for each place, and every one spreads over all of the surface that the gap does.
double most_in_vain(const Mesh& mesh, const PlacingRules& rules, const DistributionOptions& options) {
  constexpr double k_per_copy = 200;
  if (options.gap <= 0 || options.maximal) return std::numeric_limits<double>::infinity();
  return k_per_copy * std::max(1.0, mesh.area() / rules.smallest_body_area());
}

/// Allows fewer that all reach beyond the boundary. When ten for each place find no room, all the room is, nineteen
/// times in twenty, smaller than 0.3 copies. Strands of hair narrower than the shapes would take millions.
double most_beyond(const Mesh& mesh, const PlacingRules& rules, const DistributionOptions& options) {
  constexpr double k_per_copy = 10, k_least = 10'000;
  if (options.maximal) return std::numeric_limits<double>::infinity();
  return std::max(k_least, k_per_copy * mesh.area() / rules.smallest_body_area());
}

std::size_t rejection_of(Outcome outcome) {
  return static_cast<std::size_t>(outcome) - static_cast<std::size_t>(Outcome::collision);
}

}  // namespace

Insertion::Insertion(const Mesh& mesh, const PlacingRules& rules, const DistributionOptions& options)
    : mesh_(&mesh),
      rules_(&rules),
      forbidden_(options.forbidden),
      threads_(thread_count(options.threads)),
      settled_(mesh, rules.flat(), rules.smallest_radius(), rules.largest_radius()),
      wanted_(options.counts),
      shares_(options.density.empty() ? options.shares : std::vector<double>()),
      most_in_vain_(most_in_vain(mesh, rules, options)),
      most_beyond_(most_beyond(mesh, rules, options)),
      touched_(static_cast<std::size_t>(mesh.face_count()), 0) {
  for (const Kind& kind : rules.kinds()) inserted_.resize(static_cast<std::size_t>(kind.shape) + 1, 0);
  mappers_.resize(static_cast<std::size_t>(threads_));
  surroundings_.resize(static_cast<std::size_t>(threads_));
}

bool Insertion::is_any_wanted() const {
  for (Index shape = 0; shape < static_cast<Index>(inserted_.size()); ++shape)
    if (wanted_.empty() || inserted_[shape] < wanted_[shape]) return true;
  return false;
}

bool Insertion::is_hopeless() const {
  if (inserted_in_all_ > 0) return false;
  const auto all = std::accumulate(rejections_.begin(), rejections_.end(), std::int64_t{0});
  const std::int64_t beyond = rejections_[rejection_of(Outcome::boundary)];
  return static_cast<double>(all) >= (beyond == all ? std::min(most_beyond_, most_in_vain_) : most_in_vain_);
}

double Insertion::share(Index shape) const {
  if (!wanted_.empty()) return std::max(0, wanted_[shape] - inserted_[shape]);
  if (shares_.empty()) return 1;
  // Those that are behind are tried much more often than their share.
  return std::max(0.0, shares_[shape] * (1.1 * inserted_in_all_ + 20) - inserted_[shape]);
}

bool Insertion::is_foreseen_to_meet(const Copy& copy) const {
  const SurfacePoint& center = copy.placement.center;
  const Vec2 place = rules_->flat().place(center);
  const double c = copy.placement.scale * std::cos(copy.placement.angle),
               s = copy.placement.scale * std::sin(copy.placement.angle);
  Eigen::Matrix2d own;
  own << c, -s, s, c;
  return settled_.visit(
      center.face, {center.barycentric[1], center.barycentric[2]}, copy.radius(),
      [&](Index number, const Vec2& origin, const Eigen::Matrix2d& turn) {
        const Copy& other = settled_.copies()[number];
        const Pose pose{origin + turn * place, turn * own};
        const double reach = copy.radius() + other.radius();
        if (pose.at.squaredNorm() > reach * reach || !boxes_meet(*copy.body, pose, *other.body, other.placement.scale))
          return false;
        const Search deep{.least = 0, .enough = 0, .most_disks = 4};
        return find_overlap(*copy.body, copy.placement.scale, pose, {}, *other.body, other.placement.scale, deep)
                       .depth > 0 ||
               outlines_cross(copy.body->shape, pose, other.body->shape, other.placement.scale);
      });
}

void Insertion::attempt(const Candidate& candidate, Attempt& attempt, int thread) const {
  const auto& [key, kind, cell, center, scale, is_thorough, is_probe, lying] = candidate;
  attempt.is_lying = lying != nullptr;
  attempt.copy = lying ? rules_->copy(*lying) : rules_->copy(kind, center, rules_->field_angle(kind, center), scale);
  if (!lying && !is_wanted(attempt.copy.placement.shape)) {
    attempt.outcome = Outcome::not_wanted;
    return;
  }
  if (!is_thorough && !is_probe && is_foreseen_to_meet(attempt.copy)) {
    attempt.outcome = Outcome::collision;
    return;
  }
  auto& mapper = mappers_[thread];
  if (!mapper) mapper = std::make_unique<OutlineMapper>(*mesh_);
  map(attempt, *mapper);
  if (lying && are_apart_ && attempt.outcome != Outcome::laid) {  // too near to the rim for the gap around it
    attempt.copy = rules_->bare_copy(*lying);
    map(attempt, *mapper);
  }
}

/// Maps the copy, and tests it.
void Insertion::map(Attempt& attempt, OutlineMapper& mapper) const {
  Placement placement = attempt.copy.placement;
  const std::optional<CenterLine> line = rules_->line(placement);
  placement.mirrored = false;  // the body is
  const auto loops = attempt.copy.body->shape.loops();
  const MapFailure failure =
      line ? mapper.map_along(loops, placement, *line, attempt.outline) : mapper.map(loops, placement, attempt.outline);
  attempt.outcome = outcome_of(failure);
  if (attempt.outcome != Outcome::laid) return;
  const ShapeMap& plane = mapper.plane();
  // Along a curve that the copy does not point along its plane is turned.
  const auto place_of = [&](Index vertex) -> Vec2 {
    return line ? Vec2(placement.scale * mapper.given(plane.coordinates(vertex))) : plane.coordinates(vertex);
  };
  attempt.faces.clear();
  for (const Index face : attempt.outline.faces) {
    const Triangle& corners = mesh_->triangles()[face];
    const Vec2 origin = place_of(corners[0]), e1 = place_of(corners[1]) - origin, e2 = place_of(corners[2]) - origin;
    attempt.faces.push_back({face, origin, rules_->flat().turn_to(face, e1, e2)});
  }
  test(attempt);
  if (attempt.outcome != Outcome::laid) return;
  attempt.plane.clear();
  for (const Index vertex : plane.vertices()) attempt.plane.push_back({vertex, place_of(vertex)});
}

/// Tells whether a copy that has been mapped has room among those that lie there now.
void Insertion::test(Attempt& attempt) const {
  const auto is_forbidden = [&](Index face) { return !forbidden_.empty() && forbidden_[face]; };
  if (attempt.is_lying && are_apart_) return;
  if (std::any_of(attempt.outline.faces.begin(), attempt.outline.faces.end(), is_forbidden))
    attempt.outcome = Outcome::forbidden;
  else if (!settled_.is_free(attempt.copy, attempt.outline, attempt.faces))
    attempt.outcome = Outcome::collision;
}

/// Lays a copy that had room before its batch, if it still has. Returns what became of it.
Outcome Insertion::commit(Attempt& attempt) {
  if (!attempt.is_lying && !is_wanted(attempt.copy.placement.shape)) return Outcome::not_wanted;
  const auto& faces = attempt.outline.faces;
  if (std::any_of(faces.begin(), faces.end(), [&](Index face) { return touched_[face] == batch_; })) test(attempt);
  if (attempt.outcome == Outcome::laid) {
    attempt.copy.bend = std::max(attempt.outline.largest - 1, 1 - attempt.outline.smallest);
    const auto number = static_cast<Index>(settled_.copies().size());
    settled_.add(attempt.copy, attempt.outline);
    settled_.add_places(number, attempt.faces, true);
    pending_.push_back({number, std::move(attempt.plane), attempt.outline.faces});
    ++inserted_[attempt.copy.placement.shape];
    ++inserted_in_all_;
    for (const Index face : faces) touched_[face] = batch_;
  }
  return attempt.outcome;
}

void Insertion::keep(std::span<const Placement> lying, bool are_apart, const JobStage& stage) {
  are_apart_ = are_apart;
  std::vector<Candidate> candidates;
  candidates.reserve(lying.size());
  for (const Placement& copy : lying)
    candidates.push_back({.key = static_cast<double>(candidates.size()),
                          .kind = k_none,
                          .cell = k_none,
                          .center = copy.center,
                          .scale = copy.scale,
                          .is_thorough = true,
                          .lying = &copy});
  const std::vector<Outcome> outcomes = insert(candidates, stage);
  const auto is_laid = [](Outcome outcome) { return outcome == Outcome::laid; };
  const auto refused = std::find_if_not(outcomes.begin(), outcomes.end(), is_laid);
  if (refused != outcomes.end())
    throw InputError(message("around: copy ", refused - outcomes.begin(), reason_of(*refused)));
}

void Insertion::make_pending_known() {
  parallel_for(static_cast<Index>(pending_.size()), threads_, 1, [&](Index i, int thread) {
    auto& surroundings = surroundings_[thread];
    if (!surroundings) surroundings = std::make_unique<LocalLayout>(*mesh_, rules_->flat());
    const auto& [copy, plane, faces] = pending_[i];
    settled_.add_places(copy, surroundings->about(plane, faces, settled_.reach(settled_.copies()[copy])), false);
  });
  pending_.clear();
}

std::vector<Outcome> Insertion::insert(std::span<const Candidate> candidates, const JobStage& stage,
                                       std::span<const std::uint64_t> face_order) {
  const auto count = static_cast<Index>(candidates.size());
  std::vector<Outcome> outcomes(candidates.size(), Outcome::not_wanted);
  std::vector<std::uint64_t> keys(candidates.size());
  // As numbers, the bits of what is not negative are in the same order.
  parallel_for(count, threads_, k_sorted_at_once,
               [&](Index i, int) { keys[i] = std::bit_cast<std::uint64_t>(candidates[i].key + 0.0); });
  const std::vector<Index> order = order_of(keys, threads_, stage);
  std::vector<Index> turns;
  // Side by side: most are turned away, and to fetch their attempts from other threads would take long.
  std::array<Outcome, k_largest_batch> found;
  std::size_t size = k_first_batch;
  const auto goes_on = [&] { return candidates[0].lying || (is_any_wanted() && !is_hopeless()); };
  for (std::size_t begin = 0, end; begin < order.size() && goes_on(); begin = end) {
    stage.update(static_cast<double>(begin) / static_cast<double>(order.size()));
    end = std::min(order.size(), begin + size);
    ++batch_;
    attempts_.resize(std::max(attempts_.size(), end - begin));
    if (!face_order.empty()) {
      keys.resize(end - begin);
      for (std::size_t i = begin; i < end; ++i) keys[i - begin] = face_order[candidates[order[i]].center.face];
      turns = order_of(keys, threads_);
    }
    parallel_for(static_cast<Index>(end - begin), threads_, k_share, [&](Index i, int thread) {
      stage.check();
      const Index turn = turns.empty() ? i : turns[i];
      attempt(candidates[order[begin + turn]], attempts_[turn], thread);
      found[turn] = attempts_[turn].outcome;
    });
    std::size_t laid = 0, in_vain = 0;  // in vain: mapped, and turned away for another of the batch
    for (std::size_t i = begin; i < end; ++i) {
      stage.check();
      Outcome& outcome = outcomes[order[i]] = found[i - begin];
      if (outcome == Outcome::laid) {
        outcome = commit(attempts_[i - begin]);
        ++(outcome == Outcome::laid ? laid : in_vain);
      }
      if (outcome > Outcome::not_wanted) ++rejections_[rejection_of(outcome)];
    }
    make_pending_known();
    if (2 * in_vain > laid) size = std::max(k_least_batch, size / 2);
    if (8 * in_vain <= laid) size = std::min(k_largest_batch, size * 2);
  }
  return outcomes;
}

}  // namespace saddleback::distribution
