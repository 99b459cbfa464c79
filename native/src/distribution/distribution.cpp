#include "saddleback/distribution.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "saddleback/error.h"
#include "saddleback/sample.h"

#include "gap_search.h"
#include "laying.h"
#include "placing_rules.h"
#include "support/random_numbers.h"

namespace saddleback {
namespace {

using namespace distribution;

void check_per_vertex(const char* name, const Mesh& mesh, const std::vector<double>& values, bool may_be_zero) {
  if (values.size() != static_cast<std::size_t>(mesh.vertex_count()))
    throw InputError(
        message(name, " has ", values.size(), " values, but the mesh has ", mesh.vertex_count(), " vertices"));
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]))
      throw InputError(message(name, ": value ", values[i], " at [", i, "] is not finite"));
    if (values[i] < 0 || (values[i] == 0 && !may_be_zero))
      throw InputError(message(name, ": value ", values[i], " at [", i, "] is not positive"));
  }
}

void check_counts(std::span<const Shape> shapes, const DistributionOptions& options) {
  if (options.counts.empty()) return;
  if (options.counts.size() != shapes.size())
    throw InputError(
        message("counts has ", options.counts.size(), " values, but there are ", shapes.size(), " shapes"));
  for (std::size_t i = 0; i < options.counts.size(); ++i)
    if (options.counts[i] < 0) throw InputError(message("counts: ", options.counts[i], " at [", i, "] is negative"));
}

void check_sizes(const Mesh& mesh, std::span<const Shape> shapes, const DistributionOptions& options) {
  if (options.size.size() == 1) {
    if (!(options.size[0] > 0) || !std::isfinite(options.size[0]))
      throw InputError(message("size is ", options.size[0], ", but must be positive and finite"));
  } else {
    check_per_vertex("size", mesh, options.size, false);
  }
  if (!(options.smallest > 0) || !(options.largest >= options.smallest) || !std::isfinite(options.largest))
    throw InputError(message("sizes from ", options.smallest, " to ", options.largest, " are no range above 0"));
  const double least = *std::min_element(options.size.begin(), options.size.end()) * options.smallest;
  for (std::size_t i = 0; i < shapes.size(); ++i)
    if (shapes[i].area() * least * least > mesh.area())
      throw InputError(message("size: shape ", i, " has an area of ", shapes[i].area() * least * least,
                               ", larger than the surface, which has ", mesh.area()));
}

void check_density(const Mesh& mesh, const DistributionOptions& options) {
  if (options.density.empty()) return;
  check_per_vertex("density", mesh, options.density, true);
  if (std::all_of(options.density.begin(), options.density.end(), [](double v) { return v == 0; }))
    throw InputError("density is zero everywhere: no place is left for a shape");
  if (options.counts.empty()) throw InputError("density: tells where, but counts must tell how many");
  if (options.maximal)
    throw InputError("density: a surface that is full everywhere cannot follow it; let size follow it instead");
}

void check(const Mesh& mesh, std::span<const Shape> shapes, const DistributionOptions& options) {
  if (shapes.empty()) throw InputError("shapes: wanted at least one");
  check_counts(shapes, options);
  check_sizes(mesh, shapes, options);
  check_density(mesh, options);
  if (options.field && &options.field->mesh() != &mesh) throw InputError("field: is one of another mesh");
  if (!options.forbidden.empty() && options.forbidden.size() != static_cast<std::size_t>(mesh.face_count()))
    throw InputError(
        message("forbidden has ", options.forbidden.size(), " values, but the mesh has ", mesh.face_count(), " faces"));
  if (!options.forbidden.empty() &&
      std::all_of(options.forbidden.begin(), options.forbidden.end(), [](std::uint8_t v) { return v != 0; }))
    throw InputError("forbidden: no face is left for a shape");
  if (!(options.gap >= 0) || !std::isfinite(options.gap))
    throw InputError(message("gap is ", options.gap, ", but must be finite and not negative"));
  if (!(options.packing >= 0 && options.packing <= 1))
    throw InputError(message("packing is ", options.packing, ", but must be 0 to 1"));
  if (!(options.tolerance >= 0.001 && options.tolerance <= 0.5))
    throw InputError(message("tolerance is ", options.tolerance, ", but must be 0.001 to 0.5"));
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

/// Copies at places that follow the density evenly. Those that find no room are tried at other such places.
DistributionStop follow_density(const Mesh& mesh, const PlacingRules& rules, Laying& laying,
                                const DistributionOptions& options, const JobStage& stage) {
  constexpr int k_attempts = 12;
  for (int attempt = 0; attempt < k_attempts && laying.is_any_wanted(); ++attempt) {
    std::vector<Index> missing;
    for (std::size_t shape = 0; shape < options.counts.size(); ++shape)
      missing.push_back(static_cast<Index>(laying.share(static_cast<Index>(shape))));
    const std::vector<Index> turns = interleaved(missing);
    const std::uint64_t key = mixed(options.seed, static_cast<std::uint64_t>(attempt));
    const SurfacePoints places = sample(mesh, static_cast<Index>(turns.size()), options.density, key);
    std::vector<Candidate> candidates;
    for (std::size_t i = 0; i < places.size(); ++i) {
      std::vector<Index> kinds;
      for (Index k = 0; k < static_cast<Index>(rules.kinds().size()); ++k)
        if (rules.kinds()[k].shape == turns[i]) kinds.push_back(k);
      const std::uint64_t own = mixed(key, i);
      const Index kind = kinds[static_cast<std::size_t>(uniform(own, 0) * static_cast<double>(kinds.size()))];
      const double factor = options.smallest + (options.largest - options.smallest) * uniform(own, 1);
      candidates.push_back(
          {uniform(own, 2), kind, static_cast<Index>(i), places[i], rules.size_at(places[i]) * factor});
    }
    laying.lay(std::move(candidates),
               stage.part(static_cast<double>(attempt) / k_attempts, (attempt + 1.0) / k_attempts));
  }
  return laying.is_any_wanted() ? DistributionStop::tired : DistributionStop::counts;
}

}  // namespace

DistributionResult distribute(const Mesh& mesh, std::span<const Shape> shapes, const DistributionOptions& options,
                              Job* job) {
  check(mesh, shapes, options);
  const JobStage stage(job, "Shapes");
  std::optional<DirectionField> smoothest;
  if (!options.field) {
    DirectionFieldOptions even;
    smoothest = direction_field(mesh, 2, even);
  }
  const DirectionField& field = options.field ? *options.field : *smoothest;
  const PlacingRules rules(mesh, shapes, options, field, stage.part(0, 0.05));
  Laying laying(mesh, rules, options);
  DistributionResult result;
  if (!options.density.empty()) {
    result.stop = follow_density(mesh, rules, laying, options, stage.part(0.05, 1));
  } else {
    GapSearch search(mesh, rules, laying, options);
    result.stop = search.run(stage.part(0.05, 1));
    if (options.maximal) result.certificate = search.certificate();
  }
  for (const Copy& copy : laying.settled().copies()) result.placements.push_back(copy.placement);
  std::copy(laying.rejections().begin(), laying.rejections().end(), result.rejections.begin());
  stage.update(1);
  return result;
}

}  // namespace saddleback
