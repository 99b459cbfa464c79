#include "saddleback/voronoi2d/relax_2d.h"

#include <algorithm>
#include <cmath>

#include "saddleback/error.h"
#include "saddleback/voronoi2d/voronoi_2d.h"

#include "voronoi2d/clipping/raster_moments.h"

namespace saddleback {
namespace {

using voronoi2d::check_density;
using voronoi2d::energy_of;
using voronoi2d::moments_of;
using voronoi2d::RasterIntegral;
using voronoi2d::RasterMoments;

void check_options(std::span<const Vec2> sites, const Relaxation2dOptions& options) {
  if (sites.empty()) throw InputError("sites: wanted at least one site, got none");
  if (options.max_iterations < 0)
    throw InputError(message("max_iterations: wanted 0 or more, got ", options.max_iterations));
  if (!(options.tolerance >= 0)) throw InputError(message("tolerance: wanted 0 or more, got ", options.tolerance));
  check_density(options.density);
  if (!options.weights.empty() && options.weights.size() != sites.size())
    throw InputError(message("weights: wanted one for each of ", sites.size(), " sites, got ", options.weights.size()));
}

/// Sites with what they need to know of their cells to move on.
struct State {
  std::vector<Vec2> sites;
  std::vector<RasterMoments> moments;
  double energy = 0;
};

State evaluate(std::vector<Vec2> sites, const PlanarDomain& domain, const RasterIntegral& integral,
               const Relaxation2dOptions& options, const JobStage& stage) {
  const int threads = options.threads;
  const Voronoi2d diagram = options.weights.empty()
                                ? voronoi_2d(sites, {.threads = threads}, stage.part(0, 0.5))
                                : voronoi_2d(sites, options.weights, {.threads = threads}, stage.part(0, 0.5));
  const ClippedCells cells = diagram.clip(domain, {.threads = threads}, stage.part(0.5, 0.8));
  State state{std::move(sites), {}, 0};
  state.moments = moments_of(cells, static_cast<Index>(state.sites.size()), integral, threads, stage);
  state.energy = energy_of(state.sites, state.moments, integral);
  stage.update(1);
  return state;
}

std::vector<Vec2> moved_sites(const State& state, const RasterIntegral& integral, double least_mass) {
  std::vector<Vec2> sites = state.sites;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const RasterMoments& cell = state.moments[i];
    if (cell.mass > least_mass) sites[i] = integral.middle() + cell.first / cell.mass;
  }
  return sites;
}

double largest_move(const std::vector<Vec2>& from, const std::vector<Vec2>& to) {
  double largest = 0;
  for (std::size_t i = 0; i < from.size(); ++i) largest = std::max(largest, (to[i] - from[i]).norm());
  return largest;
}

}  // namespace

Relaxation2d relax_2d(std::span<const Vec2> sites, const PlanarDomain& domain, const Relaxation2dOptions& options,
                      Job* job) {
  check_options(sites, options);
  const JobStage stage(job, "Finding cells");
  const RasterIntegral integral(domain, options.density, 2);
  RasterMoments whole;
  for (const std::vector<Vec2>& loop : domain.loops()) whole += integral.along(loop);
  // Sums from the raster's left side on leave a cell without density with a mass of rounding; it must not move a site.
  constexpr double k_rounding = 1e-14;
  const double least_mass = k_rounding * whole.mass;
  if (!(whole.mass > 0)) throw InputError("density: it is 0 all over the domain");

  const double part = 1.0 / (options.max_iterations + 1);
  Relaxation2d result;
  result.stop_reason = "max_iterations";
  const bool has_weights = !options.weights.empty();
  const double rest = options.tolerance * std::sqrt(domain.area() / static_cast<double>(sites.size()));
  const auto tell_energy = [&](const State& of) {
    result.energy.push_back(std::ldexp(of.energy, 2 * integral.exponent()));
  };
  State state = evaluate({sites.begin(), sites.end()}, domain, integral, options, stage.part(0, part));
  tell_energy(state);
  while (result.iterations < options.max_iterations) {
    const JobStage step =
        stage.part((result.iterations + 1) * part, (result.iterations + 2) * part,
                   message("Relaxing sites, step ", result.iterations + 1, " of ", options.max_iterations));
    State next = evaluate(moved_sites(state, integral, least_mass), domain, integral, options, step);
    if (!has_weights && next.energy > state.energy) {  // by rounding only
      result.converged = true;
      result.stop_reason = "no step lowers the energy";
      break;
    }
    const double fall = state.energy - next.energy;
    const double move = has_weights ? largest_move(state.sites, next.sites) : 0;
    state = std::move(next);
    tell_energy(state);
    ++result.iterations;
    if (has_weights ? move <= rest : fall <= options.tolerance * state.energy) {
      result.converged = true;
      result.stop_reason = "tolerance";
      break;
    }
  }
  result.sites = std::move(state.sites);
  stage.update(1);
  return result;
}

}  // namespace saddleback
