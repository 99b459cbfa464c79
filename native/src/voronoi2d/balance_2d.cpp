#include "saddleback/voronoi2d/balance_2d.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "saddleback/error.h"
#include "saddleback/voronoi2d/power_diagram_2d.h"

#include "support/sparse_cholesky.h"
#include "support/threads/parallel.h"
#include "voronoi2d/clipping/edges_within.h"
#include "voronoi2d/clipping/raster_moments.h"

namespace saddleback {
namespace {

using voronoi2d::DomainMap;
using voronoi2d::EdgesWithin;
using voronoi2d::RasterIntegral;
using voronoi2d::RasterMoments;

void check_capacities(const char* name, const char* of_one, std::span<const double> capacities, std::size_t count) {
  if (capacities.empty()) return;
  if (capacities.size() != count)
    throw InputError(message(name, ": wanted one for each of ", count, " sites, got ", capacities.size()));
  for (std::size_t i = 0; i < capacities.size(); ++i)
    if (!(capacities[i] > 0) || std::isinf(capacities[i]))
      throw InputError(message(name, ": ", of_one, " ", i, " is ", capacities[i], ", wanted a positive number"));
  if (!std::isfinite(std::accumulate(capacities.begin(), capacities.end(), 0.0)))
    throw InputError(message(name, ": their sum is more than any number"));
}

void check_options(std::span<const Vec2> sites, const Balance2dOptions& options) {
  if (sites.empty()) throw InputError("sites: wanted at least one site, got none");
  if (options.max_iterations < 0)
    throw InputError(message("max_iterations: wanted 0 or more, got ", options.max_iterations));
  for (const auto& [name, value] :
       {std::pair("tolerance", options.tolerance), std::pair("capacity_tolerance", options.capacity_tolerance)})
    if (!(value >= 0)) throw InputError(message(name, ": wanted 0 or more, got ", value));
  voronoi2d::check_density(options.density);
  const std::span<const double> capacities = options.capacities;
  check_capacities("capacities", "capacity", capacities, sites.size());
  if (capacities.empty()) return;
  const double sum = std::accumulate(capacities.begin(), capacities.end(), 0.0);
  constexpr double k_slack = 1e-6;
  if (std::fabs(sum - 1) > k_slack)
    throw InputError(message("capacities: they sum to ", sum, ", wanted shares of the whole mass, which sum to 1"));
}

/// Sites and weights with what follows from them.
struct State {
  std::vector<Vec2> sites;
  std::vector<double> weights;
  Voronoi2d diagram;
  std::vector<RasterMoments> cells;
  double least = 0;    ///< of the cells' masses
  double missing = 0;  ///< the norm of what cells lack or have too much
  double error = 0;    ///< the largest of it, in shares of the capacity
};

class Balancer {
 public:
  /// Says whether cells are those of the power diagram, or of the additively weighted one.
  enum class Cells { power, curved };
  Balancer(std::size_t count, const PlanarDomain& domain, const Balance2dOptions& options, Cells kind)
      : domain_(domain),
        options_(options),
        is_curved_(kind == Cells::curved),
        integral_(domain, options.density, 1),
        map_(domain, std::clamp(static_cast<Index>(0.5 * std::sqrt(static_cast<double>(count))), 1, 1024)) {
    RasterMoments whole;
    for (const std::vector<Vec2>& loop : domain.loops()) whole += integral_.along(loop);
    whole_ = whole.mass;
    if (!(whole_ > 0)) throw InputError("density: it is 0 all over the domain");
    wanted_.assign(count, whole_ / static_cast<double>(count));
    const double sum = std::accumulate(options.capacities.begin(), options.capacities.end(), 0.0);
    for (std::size_t i = 0; i < options.capacities.size(); ++i) wanted_[i] = options.capacities[i] / sum * whole_;
  }

  Balance2d run(std::span<const Vec2> sites, const JobStage& stage) {
    const double part = 1.0 / (options_.max_iterations + 1);
    Balance2d result;
    result.stop_reason = "max_iterations";
    State state = filled({sites.begin(), sites.end()}, stage.part(0, 0.2 * part));
    state = balanced(std::move(state), stage.part(0.2 * part, part, "Weighing cells"), k_most_steps);
    result.energy.push_back(energy_of(state));
    bool is_at_rest = options_.max_iterations == 0;
    while (result.iterations < options_.max_iterations && is_met(state)) {
      const int number = result.iterations + 1;
      const JobStage step = stage.part(number * part, (number + 1) * part,
                                       message("Balancing cells, step ", number, " of ", options_.max_iterations));
      State next = balanced(moved(state, step.part(0, 0.3)), step.part(0.3, 1), k_most_steps);
      const double energy = energy_of(next), before = result.energy.back();
      if (!is_met(next) || energy > before) {  // by rounding only, or a step that is too hard
        is_at_rest = is_met(next);
        result.stop_reason = is_at_rest ? "no step lowers the energy" : "capacities cannot be met";
        break;
      }
      state = std::move(next);
      result.energy.push_back(energy);
      ++result.iterations;
      if (before - energy <= options_.tolerance * before) {
        is_at_rest = true;
        result.stop_reason = "tolerance";
        break;
      }
    }
    if (!is_met(state)) result.stop_reason = "capacities cannot be met";
    result.converged = is_at_rest && is_met(state);
    result.capacity_error = state.error;
    for (const RasterMoments& cell : state.cells) result.shares.push_back(cell.mass / whole_);
    result.sites = std::move(state.sites);
    result.weights = about_zero(std::move(state.weights));
    stage.update(1);
    return result;
  }

  AreaWeights weigh(std::span<const Vec2> sites, int most, const JobStage& stage) const {
    AreaWeights result;
    State state = filled({sites.begin(), sites.end()}, stage.part(0, 0.1));
    result.lacks.push_back(state.missing / whole_);
    state = balanced(std::move(state), stage.part(0.1, 1, "Weighing cells"), most, &result.lacks);
    result.iterations = static_cast<int>(result.lacks.size()) - 1;
    result.converged = is_met(state);
    result.stop_reason = result.converged            ? "tolerance"
                         : result.iterations == most ? "max_iterations"
                                                     : "no step lowers what is missing";
    result.error = state.error;
    for (const RasterMoments& cell : state.cells) result.shares.push_back(cell.mass / whole_);
    result.weights = about_zero(std::move(state.weights));
    stage.update(1);
    return result;
  }

 private:
  static constexpr int k_most_steps = 60;

  static std::vector<double> about_zero(std::vector<double> weights) {
    const double mean = std::accumulate(weights.begin(), weights.end(), 0.0) / static_cast<double>(weights.size());
    for (double& weight : weights) weight -= mean;
    return weights;
  }

  bool is_met(const State& state) const { return state.error <= options_.capacity_tolerance; }

  double scaled_energy(const State& state) const { return voronoi2d::energy_of(state.sites, state.cells, integral_); }
  double energy_of(const State& state) const { return std::ldexp(scaled_energy(state), integral_.exponent()); }

  /// Returns Kantorovich's functional, which is concave in the weights: its slope is what the cells lack.
  double dual_energy(const State& state) const {
    double energy = scaled_energy(state);
    for (std::size_t i = 0; i < state.sites.size(); ++i)
      energy += state.weights[i] * (wanted_[i] - state.cells[i].mass);
    return energy;
  }

  State find(std::vector<Vec2> sites, std::vector<double> weights, const JobStage& stage) const {
    const int threads = options_.threads;
    State state{std::move(sites), std::move(weights), {}, {}};
    state.diagram = is_curved_ ? voronoi_2d(state.sites, state.weights, {.threads = threads}, stage.part(0, 0.6))
                               : power_diagram_2d(state.sites, state.weights, threads, stage.part(0, 0.6));
    const ClippedCells clipped =
        state.diagram.clip(domain_, {.tolerance = curve_tolerance(), .threads = threads}, stage.part(0.6, 0.9));
    state.cells = moments_of(clipped, static_cast<Index>(state.sites.size()), integral_, threads, stage);
    state.least = whole_;
    for (std::size_t i = 0; i < state.sites.size(); ++i) {
      const double mass = state.cells[i].mass, lack = wanted_[i] - mass;
      state.least = std::min(state.least, mass);
      state.missing += lack * lack;
      state.error = std::max(state.error, std::fabs(lack) / wanted_[i]);
    }
    state.missing = std::sqrt(state.missing);
    stage.update(1);
    return state;
  }

  // Of a polyline along a curved edge, so that polygons have the areas of their cells within the tolerance.
  double curve_tolerance() const {
    constexpr double k_share = 0.1;
    return k_share * std::max(options_.capacity_tolerance, 1e-9) *
           std::sqrt(domain_.area() / static_cast<double>(wanted_.size()));
  }

  // Sums from the raster's left side on leave a cell without density a mass of rounding.
  double no_mass() const { return 1e-13 * whole_; }

  /// Finds the cells without weights, and puts sites whose cell has no mass into heavy cells, off their centers.
  State filled(std::vector<Vec2> sites, const JobStage& stage) const {
    for (int round = 0;; ++round) {
      constexpr int k_most = 60;
      State state = find(sites, std::vector<double>(sites.size(), 0), stage);
      std::vector<Index> empty, heavy;
      for (std::size_t i = 0; i < sites.size(); ++i) {
        const bool is_empty = state.cells[i].mass <= no_mass();
        (is_empty ? empty : heavy).push_back(static_cast<Index>(i));
      }
      if (empty.empty()) return state;
      if (options_.max_iterations == 0 || round == k_most)
        throw InputError(message("sites: the cell of site ", empty[0],
                                 " has no mass: it lies outside, where the density is 0, or where another site is"));
      std::sort(heavy.begin(), heavy.end(), [&](Index a, Index b) {
        const double of_a = state.cells[a].mass, of_b = state.cells[b].mass;
        return of_a != of_b ? of_a > of_b : a < b;
      });
      const std::size_t moves = std::min(empty.size(), (heavy.size() + 1) / 2);
      for (std::size_t i = 0; i < moves; ++i) sites[empty[i]] = off_center(state.cells[heavy[i]], heavy[i], round);
    }
  }

  /// Returns a place of a cell to one side of its center, less far than its mass is from there.
  Vec2 off_center(const RasterMoments& cell, Index number, int round) const {
    const Vec2 center = cell.first / cell.mass;
    const double spread = std::sqrt(std::max(0.0, cell.squared / cell.mass - center.squaredNorm()));
    // Steps by these shares of the unit square are evenly spread, and take no sine, which platforms round differently.
    constexpr double k_step_x = 0.7548776662466927, k_step_y = 0.5698402909980532;
    const double steps = number % 1024 + 7 * round;
    const auto off = [&](double step) { return steps * step - std::floor(steps * step) - 0.5; };
    return integral_.middle() + center + spread * Vec2(off(k_step_x), off(k_step_y));
  }

  /// Moves sites towards the centers of their cells, so far that none loses its cell. The energy of the cells that
  /// there are falls on all of the way.
  State moved(const State& state, const JobStage& stage) const {
    for (double share = 1;; share *= 0.5) {
      std::vector<Vec2> sites = state.sites;
      for (std::size_t i = 0; i < sites.size(); ++i) {
        const Vec2 center = integral_.middle() + state.cells[i].first / state.cells[i].mass;
        sites[i] += share * (center - sites[i]);
      }
      State next = find(std::move(sites), state.weights, stage);
      constexpr double k_shortest = 1e-6;
      if (next.least > no_mass() || share < k_shortest) return next;
    }
  }

  /// Finds the weights with which all capacities are met; as near as it gets where that is not to be had.
  State balanced(State state, const JobStage& stage, int most, std::vector<double>* lacks = nullptr) const {
    const double least = 0.5 * std::min(state.least, *std::min_element(wanted_.begin(), wanted_.end()));
    for (int step = 0; step < most && !is_met(state) && least > 0; ++step) {
      const JobStage part = stage.part(step / (step + 4.0), (step + 1) / (step + 5.0));
      // Where nothing lies between cells, Newton's step sees no way from one to the other: then as if a little did.
      // Cells between sites that are a millionth of the domain apart are lost by any but far shorter steps.
      std::optional<State> next;
      for (const int halves : {0, k_halves})
        for (const double background : {0.0, 0.01, 1.0})
          if (!next) next = better(state, newton_step(state, background, part), least, halves, part);
      if (!next) break;
      state = std::move(*next);
      if (lacks) lacks->push_back(state.missing / whole_);
    }
    stage.update(1);
    return state;
  }

  static constexpr int k_halves = 20;  ///< by which a step is tried in one go

  /// Changes the weights by a share of a step with which no cell is lost and less is missing, or the dual energy rises
  /// as its slope promises.
  std::optional<State> better(const State& state, const std::vector<double>& change, double least, int first_halves,
                              const JobStage& stage) const {
    const double before = is_curved_ ? 0 : dual_energy(state);
    double slope = 0;
    for (std::size_t i = 0; i < change.size(); ++i) slope += change[i] * (wanted_[i] - state.cells[i].mass);
    constexpr double k_promised = 1e-3, k_rounding = 1e-12;
    for (int halves = first_halves; halves < first_halves + k_halves; ++halves) {
      const double share = std::ldexp(1, -halves);
      std::vector<double> weights = state.weights;
      for (std::size_t i = 0; i < weights.size(); ++i) weights[i] += share * change[i];
      State next = find(state.sites, std::move(weights), stage);
      if (next.least < least) continue;
      const double risen = is_curved_ ? 0 : dual_energy(next) - before;
      if (next.missing <= (1 - 0.5 * share) * state.missing ||
          (!is_curved_ && risen >= k_promised * share * slope && risen > k_rounding * std::fabs(before)))
        return next;
    }
    return std::nullopt;
  }

  // A cell gains what lies along its side, for half the way over the distance of the sites, when its weight grows.
  // `background`: density that is added to what there is, in shares of the mean.
  std::vector<double> newton_step(const State& state, double background, const JobStage& stage) const {
    const Voronoi2d& diagram = state.diagram;
    const EdgesWithin edges(diagram, domain_, map_);
    const auto edge_count = static_cast<Index>(diagram.edges.size());
    const std::size_t count = state.sites.size();
    const double added = background * whole_ / domain_.area();
    std::vector<double> gain(edge_count, 0);
    parallel_for(edge_count, options_.threads, 256, [&](Index edge, int) {
      if (edge % 256 == 0) stage.check();
      const auto length = [&](const Vec2& from, const Vec2& to) {
        return integral_.mass_between(from, to) + added * (to - from).norm();
      };
      const auto [left, right] = diagram.edge_sites[edge];
      if (is_curved_) return void(gain[edge] = curve_gain(state, edge, edges, length));
      edges.for_parts(edge, [&](const Vec2& from, const Vec2& to) { gain[edge] += length(from, to); });
      gain[edge] /= 2 * (state.sites[left] - state.sites[right]).norm();
    });
    SymmetricMatrix matrix;
    matrix.offsets.assign(count + 1, 0);
    for (const auto& [left, right] : diagram.edge_sites) ++matrix.offsets[left + 1], ++matrix.offsets[right + 1];
    std::partial_sum(matrix.offsets.begin(), matrix.offsets.end(), matrix.offsets.begin());
    matrix.columns.resize(matrix.offsets.back());
    matrix.values.resize(matrix.offsets.back());
    matrix.diagonal.assign(count, 0);
    std::vector<Index> next(matrix.offsets.begin(), matrix.offsets.end() - 1);
    for (Index edge = 0; edge < edge_count; ++edge) {
      const auto [left, right] = diagram.edge_sites[edge];
      for (const auto& [of, other] : {std::pair(left, right), std::pair(right, left)}) {
        matrix.columns[next[of]] = other;
        matrix.values[next[of]++] = -gain[edge];
        matrix.diagonal[of] += gain[edge];
      }
    }
    // Only differences of weights matter: the first stays. Cells that no mass joins to others still get an answer.
    const double mean =
        std::accumulate(matrix.diagonal.begin(), matrix.diagonal.end(), 0.0) / static_cast<double>(count);
    constexpr double k_slight = 1e-12;
    for (double& value : matrix.diagonal) value += k_slight * mean;
    matrix.diagonal[0] *= 2;
    std::vector<Vec3> places(count);
    std::vector<Vec2> lacks(count);
    for (std::size_t i = 0; i < count; ++i) {
      places[i] = {state.sites[i].x(), state.sites[i].y(), 0};
      lacks[i] = {wanted_[i] - state.cells[i].mass, 0};
    }
    std::vector<Index> order = dissection_order(matrix, places);
    const SparseCholesky factors(matrix, std::move(order), stage);
    const std::vector<Vec2> solved = factors.solve(lacks);
    std::vector<double> change(count);
    for (std::size_t i = 0; i < count; ++i) change[i] = solved[i].x();
    return change;
  }

  // Along a curve a cell gains the reciprocal of |u - v|, of the directions to the two sites, times what lies there.
  template <class Length>
  double curve_gain(const State& state, Index edge, const EdgesWithin& edges, const Length& length) const {
    const auto [left, right] = state.diagram.edge_sites[edge];
    const Vec2 &p = state.sites[left], &q = state.sites[right];
    std::vector<Vec2> points;
    constexpr double k_share = 1e-4;  // a slope that is near enough
    const double width = std::sqrt(domain_.area() / static_cast<double>(wanted_.size()));
    voronoi2d::add_edge_points(state.diagram, edge, k_share * width, 8 * edges.farthest(p, q), points);
    double gain = 0;
    // In pieces no longer than they are far from the sites: the reciprocal changes little along one.
    const auto add = [&](const auto& self, const Vec2& from, const Vec2& to) -> void {
      const Vec2 middle = 0.5 * from + 0.5 * to, to_left = middle - p, to_right = middle - q;
      constexpr double k_piece = 0.25, k_shortest = 1e-6;
      const double piece = (to - from).norm(), away = std::min(to_left.norm(), to_right.norm());
      if (piece > k_piece * away && piece > k_shortest * width) {
        self(self, from, middle);
        self(self, middle, to);
        return;
      }
      const double apart = (to_left.stableNormalized() - to_right.stableNormalized()).norm();
      constexpr double k_least = 1e-9;  // behind a site, where directions are alike to rounding
      gain += length(from, to) / std::max(apart, k_least);
    };
    for (std::size_t i = 0; i + 1 < points.size(); ++i)
      edges.for_parts(points[i], points[i + 1], [&](const Vec2& from, const Vec2& to) { add(add, from, to); });
    return gain;
  }

  const PlanarDomain& domain_;
  const Balance2dOptions& options_;
  bool is_curved_;
  RasterIntegral integral_;
  DomainMap map_;
  double whole_ = 0;
  std::vector<double> wanted_;
};

}  // namespace

Balance2d balance_2d(std::span<const Vec2> sites, const PlanarDomain& domain, const Balance2dOptions& options,
                     Job* job) {
  check_options(sites, options);
  const JobStage stage(job, "Finding cells");
  return Balancer(sites.size(), domain, options, Balancer::Cells::power).run(sites, stage);
}

AreaWeights weights_for_areas(std::span<const Vec2> sites, const PlanarDomain& domain,
                              const AreaWeightsOptions& options, Job* job) {
  if (sites.empty()) throw InputError("sites: wanted at least one site, got none");
  if (options.max_iterations < 0)
    throw InputError(message("max_iterations: wanted 0 or more, got ", options.max_iterations));
  if (!(options.tolerance >= 0)) throw InputError(message("tolerance: wanted 0 or more, got ", options.tolerance));
  voronoi2d::check_density(options.density);
  check_capacities("areas", "area", options.areas, sites.size());
  const Balance2dOptions all{.density = options.density,
                             .capacities = options.areas,
                             .max_iterations = 0,
                             .capacity_tolerance = options.tolerance,
                             .threads = options.threads};
  const JobStage stage(job, "Finding cells");
  return Balancer(sites.size(), domain, all, Balancer::Cells::curved).weigh(sites, options.max_iterations, stage);
}

}  // namespace saddleback
