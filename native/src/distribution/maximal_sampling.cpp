// First come random batches: candidates fall evenly all over the surface, and those that find room stay. Then rounds
// over all open cells: those that are proven covered are dropped; into each of the others a dart is thrown; what
// remains is split in four. Cells over which a copy can move by less than the tolerance are leaves: one copy is tried
// at the center, and if it does not fit, nothing fits there with that clearance. How many candidates fall on a face,
// and where, depends on that face alone: so other triangles elsewhere, or other sheets, change nothing.

#include "distribution/maximal_sampling.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "saddleback/support/large_array.h"

#include "distribution/edge_distances.h"
#include "mesh/tables/hilbert.h"
#include "mesh/tables/outgoing.h"
#include "support/key_order.h"
#include "support/random_numbers.h"
#include "support/threads/appended.h"
#include "support/threads/parallel.h"

namespace saddleback::distribution {
namespace {

/// A round that lays less than this share of all is the last one, unless everything is wanted.
constexpr double k_tired = 0.02;
/// The share of the random candidates turned away that fell where shapes cannot be laid: beyond it no room is searched
/// for, unless everything is wanted.
constexpr double k_mostly_odd = 0.4;
/// Drops of each try_batch on the area of a copy; a sweep needs many to choose from. The last ones are for when no
/// search follows.
constexpr std::array<double, 10> k_batches{2, 2, 4, 4, 8, 8, 16, 16, 32, 32};
constexpr std::array<double, 4> k_sweeping_batches{80, 40, 40, 40};
constexpr std::size_t k_searching_batches = 6, k_searching_sweeps = 2;
constexpr double k_most_drops = 1e6;                  ///< on a face
constexpr double k_few_drops = 2e6, k_few_each = 20;  ///< on all, and for each copy
/// Bounds how many are held at a time; of shapes that are tiny beside the surface there would be more than memory
/// holds.
constexpr std::size_t k_drops_held = 4'000'000, k_most_cells = 1 << 20;
/// Faces, or cells, that a thread takes at a time.
constexpr Index k_together = 2048;
/// A certificate that leaves more than this share of the surface open is not called one.
constexpr double k_unproven = 0.5;
/// Cells smaller than this share of that square get fewer darts.
constexpr double k_dart_area = 0.05, k_free_area = 0.006;  ///< the second where the center seems free
bool is_odd(Outcome outcome) { return outcome == Outcome::fold || outcome == Outcome::stretched; }

}  // namespace

MaximalSampling::MaximalSampling(const Mesh& mesh, const ClassDensities& densities, const PlacingRules& rules,
                                 Insertion& insertion, const DistributionOptions& options)
    : mesh_(&mesh),
      densities_(&densities),
      rules_(&rules),
      insertion_(&insertion),
      options_(&options),
      coverage_(mesh, rules, insertion.settled(), options) {
  if (options.packing > 0) front_ = sweep_coordinate(mesh);
  if (options.maximal)
    certificate_.tolerance = options.tolerance * (rules.radius_of_smallest_copies() + 0.5 * options.gap);
  suspected_.resize(options.maximal ? static_cast<std::size_t>(mesh.face_count()) : 0);
}

/// Returns the kinds that may be centered in a face.
std::uint64_t MaximalSampling::kinds_in(Index face) const {
  if (!options_->forbidden.empty() && options_->forbidden[face]) return 0;
  std::uint64_t kinds = 0;
  for (std::size_t k = 0; k < rules_->kinds().size(); ++k)
    if (densities_->most_relative(rules_->kinds()[k].shape, face) > 0) kinds |= std::uint64_t{1} << k;
  return kinds;
}

/// Returns the radius of the base cells: larger cells are hardly ever covered as a whole.
double MaximalSampling::base_radius() const { return 0.5 * rules_->smallest_radius(); }

/// Makes the base cells of the next faces, as many as are looked at together.
void MaximalSampling::make_base_cells(const JobStage& stage) {
  while (next_face_ < mesh_->face_count() && open_.size() < k_most_cells) {
    stage.check();
    const Index f = next_face_++;
    const std::uint64_t kinds = kinds_in(f);
    if (!kinds) continue;
    searched_area_ += mesh_->face_area(f);
    const double edge = std::max({mesh_->length(3 * f), mesh_->length(3 * f + 1), mesh_->length(3 * f + 2)});
    int level = 0;
    // Similar triangles of a needle would be as many as its length asks for, with hardly any area each.
    const double least_area = 0.1 * base_radius() * base_radius();
    while (level < 12 && edge / (1 << level) > 1.7 * base_radius() &&
           std::ldexp(mesh_->face_area(f), -2 * level) > least_area)
      ++level;
    const std::int32_t n = 1 << level;
    const auto depth = static_cast<std::uint8_t>(level);
    for (std::int32_t j = 0; j < n; ++j)
      for (std::int32_t i = 0; i + j < n; ++i) {
        open_.push_back({{f, i, j, depth, false}, kinds});
        if (i + j + 1 < n) open_.push_back({{f, i + 1, j + 1, depth, true}, kinds});
      }
  }
}

double MaximalSampling::order(const SurfacePoint& point, std::uint64_t key) const {
  const double chance = uniform(key, 3);
  if (options_->packing <= 0) return chance;
  const Triangle& t = mesh_->triangles()[point.face];
  const double front =
      front_[t[0]] * point.barycentric[0] + front_[t[1]] * point.barycentric[1] + front_[t[2]] * point.barycentric[2];
  return (1 - options_->packing) * chance + options_->packing * front;
}

void MaximalSampling::weigh_kinds() {
  kind_weights_.clear();
  for (const Kind& kind : rules_->kinds())
    kind_weights_.push_back(insertion_->share(kind.shape) * rules_->weight_of(kind));
}

Index MaximalSampling::draw_kind(std::uint64_t kinds, const SurfacePoint& point, double chance) const {
  const auto count = static_cast<Index>(kind_weights_.size());
  double total = 0;
  for (Index k = 0; k < count; ++k)
    if (kinds >> k & 1) total += weight_at(k, point);
  double pick = chance * total;
  Index kind = k_none;
  for (Index k = 0; k < count; ++k) {
    const double weight = kinds >> k & 1 ? weight_at(k, point) : 0;
    if (weight <= 0) continue;
    kind = k;
    pick -= weight;
    if (pick < 0) break;
  }
  return kind;
}

/// Returns the mean of relative(kind) as kinds are drawn where densities are even.
template <class Relative>
double MaximalSampling::mean_of(Relative&& relative) const {
  double sum = 0, total = 0;
  for (std::size_t k = 0; k < kind_weights_.size(); ++k) {
    sum += kind_weights_[k] * relative(rules_->kinds()[k].shape);
    total += kind_weights_[k];
  }
  return total > 0 ? sum / total : 0;
}

double MaximalSampling::crowding(const SurfacePoint& point) const {
  return mean_of([&](Index shape) { return densities_->relative(shape, point); });
}

/// Returns at least as much as at any point of the face.
double MaximalSampling::most_crowding(Index face) const {
  if (densities_->is_even()) return 1;
  return mean_of([&](Index shape) { return densities_->most_relative(shape, face); });
}

double MaximalSampling::mean_drops(Index face, double per_area) const {
  return std::min(most_crowding(face) * per_area * mesh_->face_area(face) / rules_->mean_square_size(face),
                  k_most_drops);
}

/// Calls visit(key of the drop, its number among random ones, point) for each.
template <class Visit>
void MaximalSampling::draw_candidates(Index face, int try_batch, double per_area, const JobStage& stage,
                                      Visit&& visit) const {
  constexpr Index k_drops_between_looks = 1 << 14;
  if (!options_->forbidden.empty() && options_->forbidden[face]) return;
  const std::uint64_t own = mixed(mixed(options_->seed, static_cast<std::uint64_t>(try_batch)), face);
  const double most = most_crowding(face);
  const auto count = static_cast<Index>(mean_drops(face, per_area) + uniform(own, 0));
  for (Index i = 0; i < count; ++i) {
    if (i % k_drops_between_looks == 0) stage.check();
    const std::uint64_t key = mixed(own, static_cast<std::uint64_t>(i) + 1);
    double along = uniform(key, 1), up = uniform(key, 2);
    if (along + up > 1) along = 1 - along, up = 1 - up;
    const SurfacePoint point = point_at(face, Vec2(along, up));
    if (densities_->is_even() || uniform(key, 5) * most < crowding(point)) visit(order(point, key), key, point);
  }
}

/// Returns how many candidates a batch draws, or somewhat more.
double MaximalSampling::expected_drops(double per_area) const {
  const Index face_count = mesh_->face_count();
  std::vector<double> sums((static_cast<std::size_t>(face_count) + k_together - 1) / k_together, 0);
  parallel_for(face_count, options_->threads, k_together,
               [&](Index f, int) { sums[f / k_together] += 1 + mean_drops(f, per_area); });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

/// Tries them in the order of their keys, as many at a time as are held.
void MaximalSampling::try_batch(int number, double per_area, const JobStage& stage) {
  constexpr std::size_t k_bins = 4096;
  const auto draw = [&](Index face, auto&& visit) { draw_candidates(face, number, per_area, stage, visit); };
  const Index face_count = mesh_->face_count();
  // Few are all held at once, in one bin.
  const double expected = expected_drops(per_area);
  const std::size_t bin_count = expected < static_cast<double>(k_drops_held) ? 1 : k_bins;
  const auto bin_of = [&](double key) {
    return static_cast<std::size_t>(std::clamp(key, 0.0, 1.0) * static_cast<double>(bin_count - 1));
  };
  std::vector<std::size_t> bins(bin_count, 1);
  const auto count_drop = [&](double key, std::uint64_t, const SurfacePoint&) {
    std::atomic_ref(bins[bin_of(key)]).fetch_add(1, std::memory_order_relaxed);
  };
  if (bin_count > 1)
    parallel_for(face_count, options_->threads, k_together, [&](Index f, int) { draw(f, count_drop); });
  const double count = static_cast<double>(std::accumulate(bins.begin(), bins.end(), std::size_t{0}));
  std::vector<Candidate> candidates;
  for (std::size_t begin = 0, end, done = 0; begin < bin_count && insertion_->is_any_wanted(); begin = end) {
    std::size_t held = bins[begin];
    for (end = begin + 1; end < bin_count && held + bins[end] <= k_drops_held;) held += bins[end++];
    candidates.clear();
    append_in_order(candidates, face_count, options_->threads, k_together, [&](Index face, auto& found) {
      draw(face, [&](double order, std::uint64_t key, const SurfacePoint& point) {
        if (bin_of(order) < begin || bin_of(order) >= end) return;
        const Index kind = draw_kind(~std::uint64_t{0}, point, uniform(key, 0));
        found.push_back({order, kind, point.face, point, drawn_scale(kind, point, uniform(key, 4))});
      });
    });
    const auto share = [&](std::size_t drop) { return static_cast<double>(drop) / count; };
    insertion_->insert(candidates, stage.part(share(done), share(done + held)));
    done += held;
    if (insertion_->is_hopeless()) break;
  }
}

/// Goes on until a try_batch lays hardly anything, or all have fallen.
DistributionStop MaximalSampling::sample_at_random(const JobStage& stage) {
  std::span<const double> batches = options_->packing > 0 ? std::span<const double>(k_sweeping_batches) : k_batches;
  if (searches()) batches = batches.first(options_->packing > 0 ? k_searching_sweeps : k_searching_batches);
  const double area = rules_->mean_area(), first = batches.front() / area;
  // Numbers of tiny copies are mostly met by far fewer candidates than would cover the surface.
  double few = first;
  const double wanted = std::accumulate(options_->counts.begin(), options_->counts.end(), 0.0);
  const double enough = std::max(k_few_drops, k_few_each * wanted) + mesh_->face_count();
  while (wanted > 0 && options_->packing <= 0 && expected_drops(few) > enough) few /= 2;
  if (few < first) {
    weigh_kinds();
    try_batch(static_cast<int>(k_batches.size()), few, stage.part(0, 0.1));
  }
  bool is_tired = false;
  for (std::size_t i = 0; i < batches.size() && insertion_->is_any_wanted(); ++i) {
    const auto part = [&](double share) {
      return (static_cast<double>(i) + share) / static_cast<double>(batches.size());
    };
    weigh_kinds();
    const std::size_t before = insertion_->settled().copies().size();
    try_batch(static_cast<int>(i), batches[i] / area, stage.part(part(0), part(1)));
    if (insertion_->is_hopeless()) break;
    const std::size_t total = insertion_->settled().copies().size();
    is_tired = static_cast<double>(total - before) < k_tired * static_cast<double>(total);
    if (is_tired && !options_->maximal) break;
  }
  if (!insertion_->is_any_wanted()) return DistributionStop::counts;
  return DistributionStop::tired;
}

std::uint64_t MaximalSampling::dart_key(const Cell& cell) const {
  return mixed(options_->seed + static_cast<std::uint64_t>(rounds_) * 0x9E37, cell.key());
}

SurfacePoint MaximalSampling::thrown_point(const Cell& cell) const {
  const std::uint64_t key = dart_key(cell);
  double along = uniform(key, 1), up = uniform(key, 2);
  if (along + up > 1) along = 1 - along, up = 1 - up;
  return point_at(cell.face, cell.weights(along, up));
}

/// Throws darts into every cell whose center seems free, unless that is for numbers alone; in others by their area.
void MaximalSampling::throw_dart(const OpenCell& open, std::uint64_t free, CellView& view, Look& look) const {
  const std::uint64_t key = dart_key(open.cell);
  const Index kind = draw_kind(free ? free : look.open, view.center, uniform(key, 0));
  if (kind == k_none) return;
  rules_->see(open.cell, rules_->kinds()[kind].shape, view);
  const double radius = view.size * rules_->smallest_factor() * rules_->shape_radius(rules_->kinds()[kind]);
  const double area = mesh_->face_area(open.cell.face) * open.cell.unit() * open.cell.unit();
  const double least = free ? k_free_area : k_dart_area;
  const bool may_be_lost = options_->maximal && view.radius < least_stuck_;
  const bool is_suspected = may_be_lost && 2 * view.radius < least_stuck_ && suspected_[open.cell.face];
  const bool is_thinned = (!free && !is_suspected) || !options_->maximal;
  if (is_thinned && area < uniform(key, 5) * least * radius * radius) return;
  if (free || is_suspected) {
    // The first cells that may be given up learn whether they have to be: their parts would ask one by one.
    look.is_probe = is_suspected || (may_be_lost && 2 * view.radius >= least_stuck_);
    look.is_central = true;
    if (open.tried.kind != kind) look.dart = kind;
  } else if (weight_at(kind, thrown_point(open.cell)) > 0) {  // 0: on an edge where the density is
    look.dart = kind;
  }
}

MaximalSampling::Look MaximalSampling::look(const OpenCell& open, CoverageTest::Neighbors& near) const {
  CellView view = rules_->view(open.cell);
  Look look{};
  look.dart = k_none;
  look.tests = static_cast<std::int16_t>(std::popcount(open.kinds));
  std::uint64_t free = 0;  // kinds of which a copy at the center seems to have room
  coverage_.find_neighbors(open.cell, view, near);
  const std::uint64_t kinds = open.kinds & ~coverage_.centrally_covered(open.cell, view, open.kinds, near);
  for (std::uint64_t rest = kinds; rest; rest &= rest - 1) {
    const auto kind = static_cast<Index>(std::countr_zero(rest));
    const Kind& what = rules_->kinds()[kind];
    if (!insertion_->is_wanted(what.shape)) continue;
    rules_->see(open.cell, what.shape, view);
    const Copy copy = rules_->copy(kind, view.center, view.angle, rules_->smallest_factor() * view.size);
    const double least = tolerance(view, what);
    const CoverageTest::Cover cover = coverage_.cover(open.cell, view, kind, copy, near, least);
    if (cover.is_whole) continue;
    const std::uint64_t bit = std::uint64_t{1} << kind;
    if (cover.motion > least) {
      if (view.radius < 0.25 * least || open.cell.level >= k_most_levels)
        look.is_lost = true;
      else
        look.open |= bit;
      if (!cover.is_central) free |= bit;
    } else if (open.tried.is(kind, Outcome::collision) || cover.is_central) {
      ++look.leaves;
    } else {
      look.asked |= bit;
    }
  }
  if (look.open) throw_dart(open, free, view, look);
  return look;
}

/// The smallest copy at the center of an open cell.
Candidate MaximalSampling::central_candidate(Index number, Index kind, std::uint64_t key) const {
  const Cell& cell = open_[number].cell;
  const SurfacePoint center = point_at(cell.face, cell.center());
  const double size = rules_->size_at(rules_->kinds()[kind].shape, cell.face, cell.center());
  return {order(center, key), kind, number, center, rules_->smallest_factor() * size};
}

/// The copies that are to be tried after looking at an open cell.
void MaximalSampling::collect_candidates(Index number, const Look& look, std::vector<Candidate>& candidates) const {
  const Cell& cell = open_[number].cell;
  if (look.dart != k_none && look.is_central) {
    candidates.push_back(central_candidate(number, look.dart, dart_key(cell)));
    candidates.back().is_probe = look.is_probe;
  } else if (look.dart != k_none) {
    const std::uint64_t key = dart_key(cell);
    const SurfacePoint point = thrown_point(cell);
    candidates.push_back({order(point, key), look.dart, number, point, drawn_scale(look.dart, point, uniform(key, 4))});
  }
  for (std::uint64_t rest = look.asked; rest; rest &= rest - 1) {
    const auto kind = static_cast<Index>(std::countr_zero(rest));
    candidates.push_back(central_candidate(number, kind, mixed(options_->seed, cell.key())));
    candidates.back().is_thorough = true;
  }
}

/// Returns which share of the candidates turned away fell where shapes cannot be laid, alone as they are.
double MaximalSampling::odd_share() const {
  const auto rejected = insertion_->rejections();
  const auto number = [](Outcome outcome) {
    return static_cast<std::size_t>(outcome) - static_cast<std::size_t>(Outcome::collision);
  };
  const std::int64_t odd = rejected[number(Outcome::fold)] + rejected[number(Outcome::stretched)];
  const std::int64_t all = std::accumulate(rejected.begin(), rejected.end(), std::int64_t{0});
  return odd > 0 ? static_cast<double>(odd) / static_cast<double>(all) : 0;
}

/// Finds the rims of places where shapes cannot be laid less finely where many candidates fell on such places.
void MaximalSampling::find_least_stuck() {
  constexpr double k_fine = 4, k_coarse = 8, k_much = 0.02;
  const double least = options_->tolerance * (rules_->smallest_radius() + 0.5 * options_->gap);
  least_stuck_ = least * (odd_share() > k_much ? k_coarse : k_fine);
}

/// The face and those about it.
void MaximalSampling::suspect(Index face) {
  for (const Index vertex : mesh_->triangles()[face]) {
    for (const Index h : outgoing(*mesh_, vertex)) {
      suspected_[Mesh::face_of(h)] = 1;
    }
  }
}

void MaximalSampling::lose(const Cell& cell) {
  certificate_.uncertified_area += mesh_->face_area(cell.face) * cell.unit() * cell.unit();
  certificate_.uncertified.push_back(point_at(cell.face, cell.center()));
}

void MaximalSampling::round(const JobStage& stage) {
  weigh_kinds();
  const auto count = static_cast<Index>(open_.size());
  const int threads = thread_count(options_->threads);
  LargeArray<Look> looks(open_.size());
  const JobStage looking = stage.part(0, 0.5);
  std::vector<CoverageTest::Neighbors> near(static_cast<std::size_t>(threads));
  std::vector<std::uint64_t> keys(open_.size());
  parallel_for(count, threads, k_together, [&](Index i, int) { keys[i] = face_order_[open_[i].cell.face]; });
  const std::vector<Index> turns = order_of(keys, threads, looking);
  parallel_for(count, threads, 64, [&](Index k, int thread) {
    if (k % 1024 == 0) looking.update(static_cast<double>(k) / static_cast<double>(count));
    looks[turns[k]] = look(open_[turns[k]], near[thread]);
  });
  for (Index i = 0; i < count; ++i) {
    certificate_.cells += looks[i].tests;
    certificate_.leaves += looks[i].leaves;
    if (looks[i].is_lost) lose(open_[i].cell);
  }
  stage.check();
  std::vector<Candidate> candidates;
  append_in_order(candidates, count, threads, k_together,
                  [&](Index i, std::vector<Candidate>& found) { collect_candidates(i, looks[i], found); });
  const std::vector<Outcome> outcomes = insertion_->insert(candidates, stage.part(0.5, 1), face_order_);
  std::vector<std::uint8_t> is_stuck(open_.size(), 0);
  inserted_in_round_ = 0;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const Candidate& candidate = candidates[k];
    const Outcome outcome = outcomes[k];
    inserted_in_round_ += outcome == Outcome::laid ? 1 : 0;
    if (is_odd(outcome) && options_->maximal) suspect(candidate.center.face);
    if (!candidate.is_thorough) {
      // Other collisions may only be foreseen.
      const bool is_mapped = candidate.is_probe || is_odd(outcome);
      if (looks[candidate.cell].is_central && is_mapped) open_[candidate.cell].tried = {candidate.kind, outcome};
      is_stuck[candidate.cell] = is_odd(outcome);
    } else if (outcome == Outcome::laid || outcome == Outcome::not_wanted) {
      looks[candidate.cell].open |= std::uint64_t{1} << candidate.kind;  // the next round finds it covered
    } else {
      ++certificate_.leaves;
      if (is_odd(outcome)) lose(open_[candidate.cell].cell);
    }
  }
  stage.check();
  const auto is_given_up = [&](Index i) {
    const bool is_known_stuck = looks[i].is_central && is_odd(open_[i].tried.outcome);
    return looks[i].open && (is_stuck[i] || is_known_stuck) && rules_->view(open_[i].cell).radius < least_stuck_;
  };
  std::vector<OpenCell> next;
  append_in_order(next, count, threads, k_together, [&](Index i, std::vector<OpenCell>& found) {
    is_stuck[i] = is_given_up(i);
    if (is_stuck[i] || !looks[i].open) return;
    for (const Cell& part : open_[i].cell.children()) found.push_back({part, looks[i].open});
    found.back().tried = open_[i].tried;  // the middle one has the same center
  });
  for (Index i = 0; i < count; ++i)
    if (is_stuck[i]) lose(open_[i].cell);
  open_ = std::move(next);
  ++rounds_;
}

/// Goes on until none is open, or (unless all is wanted) rooms become rare.
void MaximalSampling::search_cells(const JobStage& stage) {
  const int first = rounds_;
  for (double done = 0; !open_.empty() && insertion_->is_any_wanted(); done += 0.5 * (1 - done)) {
    round(stage.part(done, done + 0.5 * (1 - done)));
    const auto total = static_cast<double>(insertion_->settled().copies().size());
    const bool is_tired = static_cast<double>(inserted_in_round_) < k_tired * total && rounds_ > first + 1;
    if (!options_->maximal && (is_tired || total == 0)) break;
  }
  open_.clear();
}

/// Scans list their faces in any order; along a curve neighbors follow each other.
void MaximalSampling::order_faces() {
  const HilbertCurve curve(mesh_->positions());
  face_order_.resize(static_cast<std::size_t>(mesh_->face_count()));
  parallel_for(mesh_->face_count(), options_->threads, k_together,
               [&](Index f, int) { face_order_[f] = curve.key(mesh_->position(mesh_->from(3 * f))); });
}

DistributionStop MaximalSampling::run(const JobStage& stage) {
  constexpr double k_random_share = 0.4;  // of the work, where cells are searched after it
  const DistributionStop random_stop = sample_at_random(stage.part(0, searches() ? k_random_share : 1));
  if (random_stop == DistributionStop::counts || !searches() || insertion_->is_hopeless()) return random_stop;
  // Where the surface bends too much nearly everywhere cells are split and split again, for next to no copies.
  if (!options_->maximal && odd_share() > k_mostly_odd) return random_stop;
  find_least_stuck();
  order_faces();
  const auto share = [&] { return k_random_share + (1 - k_random_share) * next_face_ / mesh_->face_count(); };
  while (next_face_ < mesh_->face_count() && insertion_->is_any_wanted()) {
    const double begin = share();
    make_base_cells(stage);
    search_cells(stage.part(begin, share()));
    if (!options_->maximal && insertion_->settled().copies().empty()) break;
  }
  if (!insertion_->is_any_wanted()) return DistributionStop::counts;
  if (!options_->maximal) return DistributionStop::tired;
  return certificate_.uncertified_area > k_unproven * searched_area_ ? DistributionStop::unproven
                                                                     : DistributionStop::full;
}

}  // namespace saddleback::distribution
