#include "saddleback/distribution/distribution.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>

#include "saddleback/error.h"
#include "saddleback/mesh/trace.h"
#include "saddleback/support/one_or_each.h"

#include "distribution/class_densities.h"
#include "distribution/even_places.h"
#include "distribution/insertion.h"
#include "distribution/maximal_sampling.h"
#include "distribution/placing_rules.h"
#include "support/only_ratios.h"
#include "support/random_numbers.h"

namespace saddleback {
namespace {

constexpr double k_field_share = 0.3;  ///< of the work, where the field is to be made as well
constexpr double k_even_share = 0.3;   ///< of the rest, where what is missing to the counts is looked for after it

using namespace distribution;

void check_per_vertex(const std::string& name, const Mesh& mesh, const std::vector<double>& values, bool may_be_zero) {
  if (values.size() != static_cast<std::size_t>(mesh.vertex_count()))
    throw InputError(
        message(name, " has ", values.size(), " values, but the mesh has ", mesh.vertex_count(), " vertices"));
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]))
      throw InputError(message(name, ": value ", values[i], " at [", i, "] is not finite"));
    if (values[i] < 0 || (values[i] == 0 && !may_be_zero))
      throw InputError(
          message(name, ": value ", values[i], " at [", i, may_be_zero ? "] is negative" : "] is not positive"));
  }
}

void check_shares(std::span<const Shape> shapes, const DistributionOptions& options) {
  const std::vector<double>& shares = options.shares;
  if (shares.empty()) return;
  if (shares.size() != shapes.size())
    throw InputError(message("shares has ", shares.size(), " values, but there are ", shapes.size(), " shapes"));
  for (std::size_t i = 0; i < shares.size(); ++i)
    if (!(shares[i] >= 0) || !std::isfinite(shares[i]))
      throw InputError(message("shares: ", shares[i], " at [", i, "] is negative or not finite"));
  if (!(*std::max_element(shares.begin(), shares.end()) > 0)) throw InputError("shares: all are zero");
  if (options.maximal)
    throw InputError("shares: a surface that is full of whatever finds room cannot keep them; leave maximal out");
  if (options.counts.size() > 1 && options.counts.size() == shapes.size())
    throw InputError("shares: counts has a value for each shape already; wanted one, how many in all");
}

void check_counts(std::span<const Shape> shapes, const DistributionOptions& options) {
  if (options.counts.empty()) return;
  if (!options.shares.empty() && options.counts.size() == 1 && options.counts[0] >= 0) return;
  if (options.counts.size() != shapes.size())
    throw InputError(
        message("counts has ", options.counts.size(), " values, but there are ", shapes.size(), " shapes"));
  for (std::size_t i = 0; i < options.counts.size(); ++i)
    if (options.counts[i] < 0) throw InputError(message("counts: ", options.counts[i], " at [", i, "] is negative"));
}

/// Calls check(name, list, shape) for each list of an option that is given once for all shapes, or once a shape.
template <class T, class Check>
void check_each(const char* name, std::span<const Shape> shapes, const std::vector<T>& lists, Check&& check) {
  if (lists.size() != 1 && lists.size() != shapes.size())
    throw InputError(message(name, " has ", lists.size(), " lists, but there are ", shapes.size(), " shapes"));
  for (std::size_t i = 0; i < lists.size(); ++i)
    check(lists.size() == 1 ? std::string(name) : message(name, " of shape ", i), lists[i]);
}

double least_scale(const DistributionOptions& options, std::size_t shape) {
  const std::vector<double>& sizes = one_or_each(options.size, static_cast<Index>(shape));
  return *std::min_element(sizes.begin(), sizes.end()) * options.smallest;
}

void check_sizes(const Mesh& mesh, std::span<const Shape> shapes, const DistributionOptions& options) {
  check_each("size", shapes, options.size, [&](const std::string& name, const std::vector<double>& sizes) {
    if (sizes.size() != 1)
      check_per_vertex(name, mesh, sizes, false);
    else if (!(sizes[0] > 0) || !std::isfinite(sizes[0]))
      throw InputError(message(name, " is ", sizes[0], ", but must be positive and finite"));
  });
  if (!(options.smallest > 0) || !(options.largest >= options.smallest) || !std::isfinite(options.largest))
    throw InputError(message("size_range: from ", options.smallest, " to ", options.largest,
                             " is no range above 0; wanted the smallest factor, then the largest"));
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const double area = shapes[i].area() * least_scale(options, i) * least_scale(options, i);
    if (area > mesh.area())
      throw InputError(
          message("size: shape ", i, " has an area of ", area, ", larger than the surface, which has ", mesh.area()));
  }
}

/// Checks that a copy finds room together with half of the gap around it. A region that holds both has at least the
/// area of a disk whose radius is that much larger than that of a disk as large as the shape (Brunn and Minkowski).
void check_gap(const Mesh& mesh, std::span<const Shape> shapes, const DistributionOptions& options) {
  if (!(options.gap >= 0) || !std::isfinite(options.gap))
    throw InputError(message("gap is ", options.gap, ", but must be finite and not negative"));
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const double own = least_scale(options, i) * std::sqrt(shapes[i].area() / std::numbers::pi);
    const double radius = own + 0.5 * options.gap;
    const double area = std::numbers::pi * radius * radius;
    if (options.gap > 0 && area > mesh.area())
      throw InputError(message("gap is ", options.gap, ": shape ", i, " with half of it around has an area of ", area,
                               " or more, larger than the surface, which has ", mesh.area()));
  }
}

void check_density(const Mesh& mesh, std::span<const Shape> shapes, const DistributionOptions& options) {
  if (options.density.empty()) return;
  check_each("density", shapes, options.density, [&](const std::string& name, const std::vector<double>& density) {
    check_per_vertex(name, mesh, density, true);
    if (std::all_of(density.begin(), density.end(), [](double v) { return v == 0; }))
      throw InputError(message(name, " is zero everywhere: no place is left for a shape"));
  });
  if (options.counts.empty() && !options.maximal)
    throw InputError("density: tells where, but counts must tell how many, or maximal that all that fit are wanted");
}

void check_fields(const Mesh& mesh, std::span<const Shape> shapes, const DistributionOptions& options) {
  if (options.bend && options.fields.empty()) throw InputError("bend: wanted a field to bend along");
  if (options.fields.empty()) return;
  check_each("field", shapes, options.fields, [&](const std::string& name, const DirectionField* field) {
    if (&field->mesh() != &mesh) throw InputError(message(name, ": is one of another mesh"));
  });
}

void check_around(const Mesh& mesh, std::span<const Shape> shapes, const DistributionOptions& options) {
  try {
    check_placements(mesh, shapes.size(), options.around);
  } catch (const InputError& error) {
    throw InputError(message("around: ", error.what()));
  }
}

void check(const Mesh& mesh, std::span<const Shape> shapes, const DistributionOptions& options) {
  if (shapes.empty()) throw InputError("shapes: wanted at least one");
  check_shares(shapes, options);
  check_counts(shapes, options);
  check_sizes(mesh, shapes, options);
  check_gap(mesh, shapes, options);
  check_density(mesh, shapes, options);
  check_fields(mesh, shapes, options);
  check_around(mesh, shapes, options);
  if (!options.forbidden.empty() && options.forbidden.size() != static_cast<std::size_t>(mesh.face_count()))
    throw InputError(
        message("forbidden has ", options.forbidden.size(), " values, but the mesh has ", mesh.face_count(), " faces"));
  if (!options.forbidden.empty() &&
      std::all_of(options.forbidden.begin(), options.forbidden.end(), [](std::uint8_t v) { return v != 0; }))
    throw InputError("forbidden: no face is left for a shape");
  if (!(options.packing >= 0 && options.packing <= 1))
    throw InputError(message("packing is ", options.packing, ", but must be 0 to 1"));
  if (!(options.tolerance >= 0.001 && options.tolerance <= 0.5))
    throw InputError(message("tolerance is ", options.tolerance, ", but must be 0.001 to 0.5"));
}

/// Shares that sum to 1, and counts in their ratio that sum to the one given: those of the largest remainders are
/// rounded up.
void share_out(DistributionOptions& options) {
  std::vector<double>& shares = options.shares;
  if (shares.empty()) return;
  const OnlyRatios ratios(options.shares);
  shares = std::vector<double>(ratios.values().begin(), ratios.values().end());
  const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (double& share : shares) share /= sum;
  if (options.counts.empty()) return;
  const Index total = options.counts[0];
  std::vector<std::pair<double, std::size_t>> remainders;
  options.counts.clear();
  Index given = 0;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const double wanted = shares[i] * total;
    options.counts.push_back(static_cast<Index>(wanted));
    given += options.counts[i];
    remainders.push_back({options.counts[i] - wanted, i});
  }
  std::sort(remainders.begin(), remainders.end());
  for (Index i = 0; i < total - given; ++i) ++options.counts[remainders[i].second];
}

/// Shapes in an order in which each comes as often, and as evenly, as it is wanted.
std::vector<Index> interleaved(const std::vector<Index>& counts) {
  std::vector<std::pair<double, Index>> turns;
  for (std::size_t shape = 0; shape < counts.size(); ++shape)
    for (Index i = 0; i < counts[shape]; ++i) turns.push_back({(i + 0.5) / counts[shape], static_cast<Index>(shape)});
  std::sort(turns.begin(), turns.end());
  std::vector<Index> result;
  for (const auto& turn : turns) result.push_back(turn.second);
  return result;
}

/// Places copies so that they follow a density evenly.
class DensityFollower {
 public:
  DensityFollower(const Mesh& mesh, const ClassDensities& densities, const PlacingRules& rules, Insertion& insertion,
                  const DistributionOptions& options)
      : mesh_(mesh), densities_(densities), rules_(rules), insertion_(insertion), options_(options) {}

  /// Every copy has a place of its own; one that finds no room there tries farther and farther about it.
  DistributionStop run(const JobStage& stage) {
    constexpr int k_attempts = 24;
    find_places();
    std::vector<Index> missing(turns_.size());
    std::iota(missing.begin(), missing.end(), 0);
    for (int attempt = 0; attempt < k_attempts && insertion_.is_any_wanted(); ++attempt) {
      const double spread = 2.0 * attempt / k_attempts;
      std::vector<Candidate> candidates;
      for (const Index which : missing) candidates.push_back(candidate(which, attempt, spread));
      const std::vector<Outcome> outcomes = insertion_.insert(
          candidates, stage.part(static_cast<double>(attempt) / k_attempts, (attempt + 1.0) / k_attempts));
      std::erase_if(missing, [&, i = std::size_t{0}](Index) mutable { return outcomes[i++] == Outcome::laid; });
    }
    return insertion_.is_any_wanted() ? DistributionStop::tired : DistributionStop::counts;
  }

 private:
  /// The shape of each copy, and its place: of a density for all shapes in turn; else each by its own.
  void find_places() {
    if (options_.density.size() == 1) {
      turns_ = interleaved(options_.counts);
      places_ = even_places(mesh_, static_cast<Index>(turns_.size()), options_.density[0], options_.seed);
      return;
    }
    for (std::size_t shape = 0; shape < options_.counts.size(); ++shape) {
      const std::uint64_t seed = mixed(options_.seed, shape);
      const SurfacePoints own = even_places(mesh_, options_.counts[shape], options_.density[shape], seed);
      turns_.insert(turns_.end(), own.size(), static_cast<Index>(shape));
      places_.insert(places_.end(), own.begin(), own.end());
    }
  }

  /// The area that a copy has at a place where the densities are met.
  double room_at(const SurfacePoint& place) const {
    const std::vector<double>& masses = densities_.masses();
    const auto room = [&](std::size_t i, double count) {
      const double density = densities_.of_list(i, place.face, place.barycentric);
      return masses[i] / count / std::max(density, 1e-9 * masses[i] / mesh_.area());
    };
    if (masses.size() == 1) return room(0, static_cast<double>(turns_.size()));
    double copies = 0;
    for (std::size_t i = 0; i < masses.size(); ++i)
      if (options_.counts[i] > 0) copies += 1 / room(i, options_.counts[i]);
    return 1 / copies;
  }

  /// `spread` in units of the distance between copies where the density is met.
  Candidate candidate(Index which, int attempt, double spread) const {
    const std::uint64_t key = mixed(mixed(options_.seed, static_cast<std::uint64_t>(attempt)), which);
    SurfacePoint place = places_[which];
    if (attempt > 0) {
      const double apart = std::sqrt(room_at(place));
      const double length = spread * std::min(apart, std::sqrt(mesh_.area())) * std::sqrt(uniform(key, 3));
      const SurfacePoint moved = trace_end(mesh_, place, 2 * std::numbers::pi * uniform(key, 4), length).point;
      if (densities_.at(turns_[which], moved) > 0) place = moved;
    }
    std::vector<Index> kinds;
    for (Index k = 0; k < static_cast<Index>(rules_.kinds().size()); ++k)
      if (rules_.kinds()[k].shape == turns_[which]) kinds.push_back(k);
    const Index kind = kinds[static_cast<std::size_t>(uniform(key, 0) * static_cast<double>(kinds.size()))];
    const double factor = options_.smallest + (options_.largest - options_.smallest) * uniform(key, 1);
    return {uniform(key, 2), kind, which, place, rules_.size_at(turns_[which], place) * factor};
  }

  const Mesh& mesh_;
  const ClassDensities& densities_;
  const PlacingRules& rules_;
  Insertion& insertion_;
  const DistributionOptions& options_;
  std::vector<Index> turns_;  ///< the shape of each copy
  SurfacePoints places_;
};

/// Lays what lies there already. That no copies meet is asked without the gap, which they need not keep.
void lay_around(const Mesh& mesh, std::span<const Shape> shapes, const DistributionOptions& options,
                Insertion& insertion, const JobStage& stage) {
  if (options.gap > 0) {
    DistributionOptions bare = options;
    bare.gap = 0;
    const PlacingRules rules(mesh, shapes, bare, stage);
    Insertion(mesh, rules, bare).keep(options.around, false, stage.part(0, 0.5));
  }
  insertion.keep(options.around, options.gap > 0, stage.part(0.5, 1));
}

}  // namespace

DistributionResult distribute(const Mesh& mesh, std::span<const Shape> shapes, const DistributionOptions& given,
                              Job* job) {
  check(mesh, shapes, given);
  DistributionOptions options = given;
  share_out(options);
  for (std::vector<double>& density : options.density) {
    const OnlyRatios ratios(density);
    density = std::vector<double>(ratios.values().begin(), ratios.values().end());
  }
  const JobStage stage(job, "Shapes");
  std::optional<DirectionField> smoothest;
  const bool has_field = !options.fields.empty();
  if (!has_field) {
    const DirectionFieldOptions even;
    smoothest = direction_field(mesh, 2, even, stage.part(0, k_field_share));
    options.fields = {&*smoothest};
  }
  const JobStage laid = has_field ? stage : stage.part(k_field_share, 1);
  const PlacingRules rules(mesh, shapes, options, laid.part(0, 0.05));
  Insertion insertion(mesh, rules, options);
  if (!options.around.empty()) lay_around(mesh, shapes, options, insertion, laid.part(0.05, 0.1));
  DistributionResult result;
  const ClassDensities densities(mesh, options.density);
  JobStage rest = laid.part(options.around.empty() ? 0.05 : 0.1, 1);
  if (!densities.is_even() && !options.counts.empty()) {
    const double share = options.maximal ? k_even_share : 1;
    result.stop = DensityFollower(mesh, densities, rules, insertion, options).run(rest.part(0, share));
    rest = rest.part(share, 1);
  }
  if (densities.is_even() || options.maximal) {
    MaximalSampling search(mesh, densities, rules, insertion, options);
    result.stop = search.run(rest);
    if (options.maximal) result.certificate = search.certificate();
  }
  for (const Copy& copy : insertion.settled().copies()) result.placements.push_back(copy.placement);
  std::copy(insertion.rejections().begin(), insertion.rejections().end(), result.rejections.begin());
  stage.update(1);
  return result;
}

}  // namespace saddleback
