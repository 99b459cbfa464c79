#include "field/connection/prescribed_indices.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>

#include "saddleback/error.h"

namespace saddleback {
namespace {

/// Writes "1/2" for 2 units of symmetry 4.
std::string as_fraction(std::int64_t units, int symmetry) {
  const std::int64_t divisor = std::gcd(units, static_cast<std::int64_t>(symmetry));
  return divisor == symmetry ? message(units / symmetry) : message(units / divisor, "/", symmetry / divisor);
}

std::vector<Index> units_of_vertices(const Mesh& mesh, const FilledSurface& filled,
                                     const std::vector<Singularity>& singularities) {
  std::vector<Index> units(filled.node_count, 0);
  std::vector<bool> named(filled.node_count, false);
  for (const Singularity& singularity : singularities) {
    const Index v = singularity.vertex;
    if (v < 0 || v >= mesh.vertex_count())
      throw InputError(
          message("singularities: vertex ", v, " is out of range, the mesh has ", mesh.vertex_count(), " vertices"));
    if (mesh.is_boundary(v))
      throw InputError(message("singularities: vertex ", v,
                               " lies on the boundary, where a field has no index; take an inner vertex or give its "
                               "boundary loop an index"));
    if (named[filled.node_of[v]]) throw InputError(message("singularities: vertex ", v, " is named twice"));
    named[filled.node_of[v]] = true;
    units[filled.node_of[v]] = singularity.units;
  }
  return units;
}

[[noreturn]] void refuse_sum(const FilledSurface& filled, Index component, std::int64_t sum, std::int64_t wanted,
                             int symmetry) {
  throw InputError(message("singularities: the indices of ", filled.name(component), " sum to ",
                           as_fraction(sum, symmetry), " but must sum to ", as_fraction(wanted, symmetry), ": ",
                           as_fraction(wanted - sum, symmetry), " is missing"));
}

/// Whole numbers near the reals, of a given sum: the largest remainders are rounded up.
std::vector<Index> round_to_sum(const std::vector<double>& reals, std::int64_t sum) {
  std::vector<Index> result(reals.size());
  std::vector<std::size_t> order(reals.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = 0; i < reals.size(); ++i) {
    result[i] = static_cast<Index>(std::floor(reals[i]));
    sum -= result[i];
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return reals[a] - std::floor(reals[a]) > reals[b] - std::floor(reals[b]);
  });
  for (std::size_t i = 0; sum != 0; i = (i + 1) % order.size()) {
    result[order[i]] += sum > 0 ? 1 : -1;
    sum += sum > 0 ? -1 : 1;
  }
  return result;
}

/// The nodes of loops that are free to take any index; the other loops' units are written.
std::vector<Index> free_loops(const FilledSurface& filled, int symmetry, const DirectionFieldOptions& options,
                              std::vector<Index>& units) {
  std::vector<Index> free;
  for (std::size_t i = 0; i < filled.loop_nodes.size(); ++i) {
    const bool is_given = i < options.loop_units.size() && options.loop_units[i].has_value();
    if (is_given || options.align == FieldAlignment::boundary) {
      units[filled.loop_nodes[i]] = symmetry + (is_given ? *options.loop_units[i] : 0);
    } else {
      free.push_back(filled.loop_nodes[i]);
    }
  }
  return free;
}

}  // namespace

std::vector<Index> prescribed_units(const Mesh& mesh, const FilledSurface& filled, int symmetry,
                                    const DirectionFieldOptions& options, const TrivialConnection& connection,
                                    const JobStage& stage) {
  if (options.loop_units.size() > filled.loop_nodes.size())
    throw InputError(message("loop_indices: index ", options.loop_units.size() - 1, " is out of range, the mesh has ",
                             filled.loop_nodes.size(), " boundary loops"));
  std::vector<Index> units = units_of_vertices(mesh, filled, *options.singularities);
  const std::vector<Index> free = free_loops(filled, symmetry, options, units);

  std::vector<std::int64_t> lacking(filled.components.size());
  for (std::size_t c = 0; c < lacking.size(); ++c) lacking[c] = symmetry * (2 - 2 * filled.components[c].genus);
  for (Index i = 0; i < filled.node_count; ++i) lacking[filled.component_of[i]] -= units[i];
  std::vector<std::vector<std::size_t>> free_of(lacking.size());
  for (std::size_t i = 0; i < free.size(); ++i) free_of[filled.component_of[free[i]]].push_back(i);
  bool several = false;
  for (std::size_t c = 0; c < lacking.size(); ++c) {
    const auto component = static_cast<Index>(c);
    const std::int64_t wanted = static_cast<std::int64_t>(symmetry) * filled.components[c].euler_characteristic();
    if (free_of[c].empty() && lacking[c] != 0) refuse_sum(filled, component, wanted - lacking[c], wanted, symmetry);
    if (free_of[c].size() == 1) units[free[free_of[c][0]]] = static_cast<Index>(lacking[c]);
    several = several || free_of[c].size() > 1;
  }
  if (!several) return units;

  const std::vector<double> best = connection.best_units(units, free, symmetry, stage);
  for (std::size_t c = 0; c < lacking.size(); ++c) {
    if (free_of[c].size() < 2) continue;
    std::vector<double> reals;
    for (const std::size_t i : free_of[c]) reals.push_back(best[i]);
    const std::vector<Index> rounded = round_to_sum(reals, lacking[c]);
    for (std::size_t i = 0; i < rounded.size(); ++i) units[free[free_of[c][i]]] = rounded[i];
  }
  return units;
}

}  // namespace saddleback
