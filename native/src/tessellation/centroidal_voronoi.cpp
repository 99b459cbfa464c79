#include "saddleback/centroidal_voronoi.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "saddleback/error.h"
#include "saddleback/sample.h"
#include "saddleback/trace.h"

#include "tessellation/cell_moments.h"
#include "tessellation/diagram.h"

namespace saddleback {
namespace {

// A step that raises the energy is halved this often before the sites count as resting.
constexpr int k_most_halvings = 6;

void check_options(const Mesh& mesh, const CentroidalVoronoiOptions& options) {
  if (options.max_iterations < 0)
    throw InputError(message("max_iterations: wanted 0 or more, got ", options.max_iterations));
  if (!(options.tolerance >= 0)) throw InputError(message("tolerance: wanted 0 or more, got ", options.tolerance));
  if (options.density.empty()) return;
  const auto& density = options.density;
  if (static_cast<Index>(density.size()) != mesh.vertex_count()) {
    throw InputError(
        message("density: wanted one value for each of the ", mesh.vertex_count(), " vertices, got ", density.size()));
  }
  const auto bad = std::find_if(density.begin(), density.end(), [](double d) { return !(d >= 0) || std::isinf(d); });
  if (bad != density.end()) {
    throw InputError(
        message("density: wanted finite values of 0 or more, got ", *bad, " at vertex ", bad - density.begin()));
  }
  if (std::all_of(density.begin(), density.end(), [](double d) { return d == 0; })) {
    throw InputError("density: it is 0 at every vertex; paint where cells are wanted");
  }
}

/// Sites with their cells and what is needed to move on.
struct State {
  SurfacePoints sites;
  std::unique_ptr<CellClaims> claims;
  std::vector<CellMoments> moments;
  double energy = 0;
};

State evaluate(const SaddleVertexGraph& graph, SurfacePoints sites, const FaceWeights& weights, int threads,
               const JobStage& stage) {
  State state;
  state.sites = std::move(sites);
  state.claims = std::make_unique<CellClaims>(graph, state.sites, threads, stage);
  state.moments = cell_moments(*state.claims, weights, threads, stage);
  for (const CellMoments& cell : state.moments) state.energy += cell.energy;
  return state;
}

/// The site moved by `share` of the way to its cell's centre. A cell without mass (no density, or empty) keeps its
/// site.
SurfacePoint moved(const Mesh& mesh, const SurfacePoint& site, const CellMoments& cell, double share) {
  if (!(cell.mass > 0)) return site;
  const Vec2 step = share * cell.moment / cell.mass;
  const double length = step.norm();
  if (!(length > 0) || !std::isfinite(length)) return site;
  double angle = std::atan2(step.y(), step.x());
  if (const Index vertex = vertex_at(mesh, site); vertex != k_none && !mesh.is_boundary(vertex)) {
    angle =
        (angle < 0 ? angle + 2 * M_PI : angle) * mesh.total_angle(vertex) / (2 * M_PI);  // the tangent plane is scaled
  }
  try {
    return trace_end(mesh, site, angle, length).point;
  } catch (const InputError&) {  // round a spike thinner than rounding a curve turns without end: the site stays
    return site;
  }
}

SurfacePoints moved_sites(const Mesh& mesh, const State& state, double share) {
  SurfacePoints sites = state.sites;
  for (std::size_t i = 0; i < sites.size(); ++i) sites[i] = moved(mesh, state.sites[i], state.moments[i], share);
  return sites;
}

}  // namespace

SurfacePoints initial_sites(const Mesh& mesh, Index count, std::span<const double> density, std::uint64_t seed) {
  if (count < 1) throw InputError(message("count: wanted at least 1 cell, got ", count));
  if (count < mesh.component_count()) {
    throw InputError(message("count: ", count, " cells cannot cover the mesh's ", mesh.component_count(),
                             " separate parts; ask for more cells or join the parts"));
  }
  return sample(mesh, {.count = count, .density = density, .seed = seed, .one_per_component = true});
}

CentroidalVoronoi centroidal_voronoi(const SaddleVertexGraph& graph, const SurfacePoints& sites,
                                     const CentroidalVoronoiOptions& options, Job* job) {
  const Mesh& mesh = graph.mesh();
  check_sites(mesh, sites);
  check_options(mesh, options);
  const JobStage stage(job, "Finding cells");
  const double part = 1.0 / (options.max_iterations + 1);
  const FaceWeights weights(mesh, options.density, options.threads);
  CentroidalVoronoi result;
  result.stop_reason = "max_iterations";
  State state = evaluate(graph, sites, weights, options.threads, stage.part(0, part));
  result.energy.push_back(state.energy);
  while (result.iterations < options.max_iterations) {
    const JobStage step =
        stage.part((result.iterations + 1) * part, (result.iterations + 2) * part,
                   message("Relaxing cells, step ", result.iterations + 1, " of ", options.max_iterations));
    double share = 1;
    State next = evaluate(graph, moved_sites(mesh, state, share), weights, options.threads, step);
    for (int halving = 0; next.energy > state.energy && halving < k_most_halvings; ++halving) {
      share /= 2;
      next = evaluate(graph, moved_sites(mesh, state, share), weights, options.threads, step);
    }
    if (next.energy > state.energy) {
      result.converged = true;
      result.stop_reason = "no step lowers the energy";
      break;
    }
    const double fall = state.energy - next.energy;
    state = std::move(next);
    result.energy.push_back(state.energy);
    ++result.iterations;
    if (fall <= options.tolerance * state.energy) {
      result.converged = true;
      result.stop_reason = "tolerance";
      break;
    }
  }
  result.sites = state.sites;
  result.cells = make_diagram(CellComplex(*state.claims, options.threads, stage), state.sites, stage);
  stage.update(1);
  return result;
}

}  // namespace saddleback
