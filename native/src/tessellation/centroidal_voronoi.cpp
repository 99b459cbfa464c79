#include "saddleback/tessellation/centroidal_voronoi.h"

#include <algorithm>
#include <cmath>

#include "saddleback/error.h"
#include "saddleback/mesh/sample.h"

#include "support/only_ratios.h"
#include "tessellation/cells/cell_topology.h"
#include "tessellation/relaxation/annealing.h"
#include "tessellation/relaxation/cell_cache.h"
#include "tessellation/relaxation/cells_across_curves.h"
#include "tessellation/relaxation/closed_ball.h"
#include "tessellation/relaxation/diagram.h"
#include "tessellation/relaxation/relaxation_run.h"

namespace saddleback {
namespace {

constexpr const char* k_cancelled = "cancelled";

void check_options(const Mesh& mesh, const CentroidalVoronoiOptions& options) {
  if (options.stop.max_iterations < 0)
    throw InputError(message("max_iterations: wanted 0 or more, got ", options.stop.max_iterations));
  if (!(options.stop.tolerance >= 0))
    throw InputError(message("tolerance: wanted 0 or more, got ", options.stop.tolerance));
  if (options.start.starts < 1) throw InputError(message("starts: wanted 1 or more, got ", options.start.starts));
  if (!(options.stop.least_move >= 0))
    throw InputError(message("least_move: wanted 0 or more, got ", options.stop.least_move));
  if (std::isinf(options.stop.least_move))
    throw InputError("least_move: wanted a finite number, got inf: no site would move");
  if (options.start.annealing < 0)
    throw InputError(message("annealing: wanted 0 or more, got ", options.start.annealing));
  check_density(mesh, options.density);
}

void check_count(const Mesh& mesh, Index count) {
  if (count < 1) throw InputError(message("count: wanted at least 1 cell, got ", count));
  if (count < mesh.component_count()) {
    throw InputError(message("count: ", count, " cells cannot cover the mesh's ", mesh.component_count(),
                             " separate parts; ask for more cells or join the parts"));
  }
}

void check_fixed(const CentroidalVoronoiOptions& options, Index count) {
  for (const Index site : options.constraints.fixed) {
    if (site >= 0 && site < count) continue;
    throw InputError(message("fixed: wanted sites from 0 to ", count - 1, ", got ", site));
  }
}

/// Shakes the sites, unless they had less energy before.
void shake(Relaxation& relaxation, const CentroidalVoronoiOptions& options, const JobStage& stage) {
  if (options.start.annealing == 0) return;
  const SurfacePoints sites = relaxation.state().sites;
  const std::vector<double> along = relaxation.state().along;
  const double energy = relaxation.state().energy;
  const auto keep_the_better = [&](const JobStage& last) {
    if (!(relaxation.state().energy < energy)) relaxation.go_to(sites, along, last);
  };
  try {
    anneal(relaxation, options.start.annealing, stage);
  } catch (const Cancelled&) {
    if (options.stop.return_when_cancelled) keep_the_better(JobStage());
    throw;
  }
  keep_the_better(stage);
}

/// Finds the cells of the relaxed sites, those of a cache only where sites have moved.
void show_cells(const SaddleVertexGraph& graph, const CentroidalVoronoiOptions& options, const JobStage& stage,
                CentroidalVoronoi& result) {
  const JobStage showing = options.stop.return_when_cancelled ? JobStage() : stage;
  if (!options.cache) {
    result.cells = find_cells(graph, result.sites, options.threads, options.cuda_device, showing);
    return;
  }
  const BorrowedCells cells(options.cache, CachedCells::shown, graph, options.density, options.threads,
                            options.cuda_device);
  cells->match(result.sites);
  cells->find(result.sites, showing.part(0, 0.7));
  cells->look_farther(showing.part(0.7, 0.8));
  const CandidatesOfCells candidates(cells->candidates(), options.threads);
  result.cells = make_diagram(graph.mesh(), candidates, result.sites, options.threads, showing.part(0.8, 1));
}

/// Sites on the curves and others, relaxed. Where the cell of a free site reaches across a curve, the site is put onto
/// it, and all are relaxed again: first a few steps, after which most such cells are known.
CentroidalVoronoi relax_on_curves(const SaddleVertexGraph& graph, Index count, std::uint64_t seed,
                                  const CentroidalVoronoiOptions& options, const JobStage& stage) {
  constexpr int k_first_iterations = 10, k_most_rounds = 5;
  constexpr double k_start = 0.05;   // of the first round, told as a part of it
  constexpr double k_relaxed = 0.7;  // of a round, before sites are exchanged
  const Mesh& mesh = graph.mesh();
  const HeldSites checked(mesh, options.constraints.curves, {}, 0);
  HeldStart start = held_start(mesh, count, options.constraints.curves, options.density, seed, stage.part(0, k_start));
  std::vector<Index> fixed(options.constraints.fixed.begin(), options.constraints.fixed.end());
  fixed.insert(fixed.end(), start.fixed.begin(), start.fixed.end());
  CentroidalVoronoiOptions on_curves = options;
  on_curves.constraints.fixed = fixed;
  for (int round = 0;; ++round) {
    on_curves.stop.max_iterations =
        round == 0 ? std::min(options.stop.max_iterations, k_first_iterations) : options.stop.max_iterations;
    on_curves.constraints.held = start.held;
    on_curves.closed_ball = false;
    const JobStage whole = stage.part(1 - std::pow(0.5, round), 1 - std::pow(0.5, round + 1));
    const JobStage part = whole.part(0, k_relaxed);
    CentroidalVoronoi result = relax_sites(graph, start.sites, on_curves, part);
    show_cells(graph, on_curves, part, result);
    const auto has_strays = [&] {
      start.sites = result.sites;
      return hold_stray_sites(mesh, result.cells, options.constraints.curves, fixed, start.sites, start.held);
    };
    if (result.stop_reason == k_cancelled || options.stop.max_iterations == 0) return result;
    const bool is_last = round == k_most_rounds,
               is_whole = on_curves.stop.max_iterations == options.stop.max_iterations;
    on_curves.start.annealing = 0;
    if (!is_last && (has_strays() || !is_whole)) continue;
    if (!options.closed_ball || find_dual_issues(mesh, result.cells, part).empty()) return result;
    on_curves.closed_ball = true;  // once nothing else is to change, which takes as long as all before
    const JobStage last = whole.part(k_relaxed, 1);
    CentroidalVoronoi closed = relax_sites(graph, result.sites, on_curves, last, true);
    if (closed.exchanged == 0) {
      result.issues = std::move(closed.issues);
      if (closed.stop_reason == k_cancelled) result.stop_reason = k_cancelled;
      return result;
    }
    result = std::move(closed);
    show_cells(graph, on_curves, last, result);
    if (is_last || result.stop_reason == k_cancelled || !has_strays()) return result;
  }
}

/// Has fewer faults, where those are looked for, or as many and less energy.
bool is_better(const CentroidalVoronoi& one, const CentroidalVoronoi& other) {
  if (one.issues.size() != other.issues.size()) return one.issues.size() < other.issues.size();
  return one.energy.back() < other.energy.back();
}

/// The best of the relaxations from all starts.
CentroidalVoronoi best_of_starts(const SaddleVertexGraph& graph, Index count, const CentroidalVoronoiOptions& options,
                                 const JobStage& stage) {
  CentroidalVoronoi best;
  for (int i = 0; i < options.start.starts; ++i) {
    const double part = 1.0 / options.start.starts;
    CentroidalVoronoi found = relax_count(graph, count, options.start.seed + static_cast<std::uint64_t>(i), options,
                                          stage.part(i * part, (i + 1) * part));
    const bool was_cancelled = found.stop_reason == k_cancelled;
    const bool is_known = !was_cancelled || !options.closed_ball;  // what is wrong with it
    if (i == 0 || (is_known && is_better(found, best))) best = std::move(found);
    if (!was_cancelled) continue;
    best.stop_reason = k_cancelled;
    break;
  }
  return best;
}

/// Relaxes with a density of which only ratios matter, and finds the cells of the result where they are not known.
template <class Relax>
CentroidalVoronoi relax_and_show(const SaddleVertexGraph& graph, const CentroidalVoronoiOptions& options, Job* job,
                                 Relax&& relax) {
  constexpr double k_showing = 3;  // in iterations
  const double whole = 1 + options.start.annealing + options.stop.max_iterations + k_showing,
               relaxed = 1 - k_showing / whole;
  const OnlyRatios density(options.density);
  CentroidalVoronoiOptions scaled = options;
  scaled.density = density.values();
  const JobStage stage(job, "Finding cells");
  CentroidalVoronoi result = relax(scaled, stage.part(0, relaxed));
  if (result.cells.sites.empty()) show_cells(graph, scaled, stage.part(relaxed, 1), result);
  if (options.closed_ball) result.issues = find_dual_issues(graph.mesh(), result.cells);
  if (options.stop.return_when_cancelled) {
    stage.finish();
  } else {
    stage.update(1);
  }
  return result;
}

}  // namespace

void check_density(const Mesh& mesh, std::span<const double> density) {
  if (density.empty()) return;
  if (static_cast<Index>(density.size()) != mesh.vertex_count()) {
    throw InputError(
        message("density: wanted one value for each of the ", mesh.vertex_count(), " vertices, got ", density.size()));
  }
  const auto bad = std::ranges::find_if(density, [](double d) { return !(d >= 0) || std::isinf(d); });
  if (bad != density.end()) {
    throw InputError(
        message("density: wanted finite values of 0 or more, got ", *bad, " at vertex ", bad - density.begin()));
  }
  if (std::ranges::all_of(density, [](double d) { return d == 0; })) {
    throw InputError("density: it is 0 at every vertex; paint where cells are wanted");
  }
}

double normalized_energy(const Mesh& mesh, std::span<const double> density, double energy, std::size_t count) {
  constexpr double k_hexagon = 5 / (36 * 1.7320508075688772);
  double mass = 0;  // the integral of the density
  for (Index face = 0; face < mesh.face_count(); ++face) {
    const Triangle& t = mesh.triangles()[face];
    const double mean = density.empty() ? 1 : (density[t[0]] + density[t[1]] + density[t[2]]) / 3;
    mass += mesh.face_area(face) * mean;
  }
  return energy * static_cast<double>(count) / (2 * k_hexagon * mass * mass);
}

SurfacePoints initial_sites(const Mesh& mesh, Index count, std::span<const double> density, std::uint64_t seed) {
  check_count(mesh, count);
  return sample(mesh, {.count = count, .density = density, .seed = seed, .one_per_component = true});
}

CentroidalVoronoi centroidal_voronoi(const SaddleVertexGraph& graph, const SurfacePoints& sites,
                                     const CentroidalVoronoiOptions& options, Job* job) {
  if (options.start.starts > 1) throw InputError("starts: wanted 1 where the sites are given; others are for a count");
  check_sites(graph.mesh(), sites);
  check_options(graph.mesh(), options);
  check_fixed(options, static_cast<Index>(sites.size()));
  return relax_and_show(graph, options, job, [&](const CentroidalVoronoiOptions& scaled, const JobStage& stage) {
    return relax_sites(graph, sites, scaled, stage);
  });
}

CentroidalVoronoi centroidal_voronoi(const SaddleVertexGraph& graph, Index count,
                                     const CentroidalVoronoiOptions& options, Job* job) {
  check_options(graph.mesh(), options);
  check_count(graph.mesh(), count);
  check_fixed(options, count);
  if (!options.constraints.held.empty()) throw InputError("held: wanted sites to go with it, got a count");
  return relax_and_show(graph, options, job, [&](const CentroidalVoronoiOptions& scaled, const JobStage& stage) {
    return best_of_starts(graph, count, scaled, stage);
  });
}

CentroidalVoronoi relax_count(const SaddleVertexGraph& graph, Index count, std::uint64_t seed,
                              const CentroidalVoronoiOptions& options, const JobStage& stage) {
  constexpr double k_start = 0.4;  // coarse cells take nearly as long as fine ones, but few iterations
  constexpr int k_long_run = 50;
  constexpr int k_last_iterations = 5, k_last_share = 10;  // on the mesh itself, after those on a coarse one
  if (!options.constraints.curves.empty()) return relax_on_curves(graph, count, seed, options, stage);
  using From = RelaxationStart::From;
  if (options.start.from == From::coarse_mesh && options.stop.max_iterations > k_last_iterations) {
    if (const auto sites = coarse_mesh_sites(graph, count, options, seed, stage.part(0, k_start))) {
      CentroidalVoronoiOptions last = options;
      last.start.annealing = 0;
      last.stop.max_iterations = std::max(k_last_iterations, options.stop.max_iterations / k_last_share);
      return relax_sites(graph, *sites, last, stage.part(k_start, 1));
    }
  }
  const bool coarse = options.start.from == From::coarse_to_fine ||
                      (options.start.from != From::sample && options.stop.max_iterations >= k_long_run);
  if (!coarse || options.stop.max_iterations == 0) {
    return relax_sites(graph, initial_sites(graph.mesh(), count, options.density, seed), options, stage);
  }
  return relax_sites(graph, coarse_to_fine_sites(graph, count, options, seed, stage.part(0, k_start)), options,
                     stage.part(k_start, 1));
}

CentroidalVoronoi relax_sites(const SaddleVertexGraph& graph, const SurfacePoints& sites,
                              const CentroidalVoronoiOptions& options, const JobStage& stage, bool is_relaxed) {
  constexpr double k_first = 0.5;  // of the steps, where sites may be exchanged after them
  const double part = 1.0 / (options.start.annealing + options.stop.max_iterations + 1),
               shaken = (options.start.annealing + 1) * part,
               relaxed = options.closed_ball ? shaken + k_first * (1 - shaken) : 1;
  Relaxation relaxation(graph, sites, options, stage.part(0, part));
  RelaxationLog log;
  Exchange exchange;
  const auto begin = [&] {
    log = log_of_start(relaxation);
    show(relaxation, options, log);
  };
  try {
    shake(relaxation, options, stage.part(part, shaken));
    begin();
    if (!is_relaxed) relax(relaxation, options, stage.part(shaken, relaxed), log);
    if (options.closed_ball) close_balls(relaxation, options, stage.part(relaxed, 1), log, exchange);
  } catch (const Cancelled&) {
    if (!options.stop.return_when_cancelled) throw;
    if (log.energy.empty()) begin();
    log.stop_reason = k_cancelled;
  }
  CentroidalVoronoi result;
  result.exchanged = exchange.moved;
  result.issues = std::move(exchange.left);
  result.energy = std::move(log.energy);
  result.iterations = log.iterations;
  result.converged = log.converged;
  result.stop_reason = std::move(log.stop_reason);
  const RelaxationState& best = relaxation.state();
  result.sites = best.sites;
  result.held.assign(options.constraints.held.begin(), options.constraints.held.end());
  result.normalized_energy = normalized_energy(graph.mesh(), options.density, best.energy, sites.size());
  if (!options.stop.return_when_cancelled) stage.update(1);
  return result;
}

GeodesicVoronoi relaxed_cells(const SaddleVertexGraph& graph, const SurfacePoints& sites,
                              const CentroidalVoronoiOptions& options, const JobStage& stage) {
  const CentroidalVoronoi relaxed = relax_sites(graph, sites, options, stage);
  return find_cells(graph, relaxed.sites, options.threads, options.cuda_device, stage);
}

}  // namespace saddleback
