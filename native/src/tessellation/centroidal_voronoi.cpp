#include "saddleback/centroidal_voronoi.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "saddleback/error.h"
#include "saddleback/sample.h"

#include "tessellation/cell_moments.h"
#include "tessellation/diagram.h"
#include "tessellation/held_sites.h"
#include "tessellation/limited_memory.h"
#include "tessellation/stray_cells.h"
#include "tessellation/tangent_moves.h"

namespace saddleback {
namespace {

constexpr const char* k_cancelled = "cancelled";

void check_options(const Mesh& mesh, const CentroidalVoronoiOptions& options) {
  if (options.max_iterations < 0)
    throw InputError(message("max_iterations: wanted 0 or more, got ", options.max_iterations));
  if (!(options.tolerance >= 0)) throw InputError(message("tolerance: wanted 0 or more, got ", options.tolerance));
  if (options.starts < 1) throw InputError(message("starts: wanted 1 or more, got ", options.starts));
  check_density(mesh, options.density);
}

void check_count(const Mesh& mesh, Index count) {
  if (count < 1) throw InputError(message("count: wanted at least 1 cell, got ", count));
  if (count < mesh.component_count()) {
    throw InputError(message("count: ", count, " cells cannot cover the mesh's ", mesh.component_count(),
                             " separate parts; ask for more cells or join the parts"));
  }
}

void check_fixed(const CentroidalVoronoiOptions& options, const SurfacePoints& sites) {
  for (const Index site : options.fixed) {
    if (site >= 0 && site < static_cast<Index>(sites.size())) continue;
    throw InputError(message("fixed: wanted sites from 0 to ", sites.size() - 1, ", got ", site));
  }
}

/// Sites with their cells and what is needed to move on.
struct State {
  SurfacePoints sites;
  std::vector<double> along;  ///< of held sites, see HeldSites
  std::unique_ptr<CellClaims> claims;
  std::vector<CellMoments> moments;
  double energy = 0;
};

/// The sites on their way.
class Relaxation {
 public:
  Relaxation(const SaddleVertexGraph& graph, const SurfacePoints& sites, const CentroidalVoronoiOptions& options,
             const JobStage& stage);
  /// One step that lowers the energy; false when there is none. \throw Cancelled, the state as it was.
  bool advance(const JobStage& stage);
  const State& state() const { return state_; }
  double mass() const;

 private:
  std::vector<double> reaches(const SurfacePoints& sites) const;
  State evaluate(SurfacePoints sites, std::vector<double> along, const JobStage& stage);
  void accept(State next);
  bool revive_empty_cells(const JobStage& stage);
  SurfacePoint far_place(Index site) const;
  bool advance_by(const TangentField& direction, const TangentField& gradient, const JobStage& stage);
  TangentField gradient(const State& state) const;
  TangentField lloyd_direction() const;
  TangentField quasi_newton_direction(const TangentField& gradient) const;
  void shorten(TangentField& direction) const;

  const SaddleVertexGraph& graph_;
  const CentroidalVoronoiOptions& options_;
  const VertexRings rings_;
  CellIntegrals integrals_;
  std::unique_ptr<CellClaims> spare_;  ///< memory for the next cells
  std::vector<std::uint8_t> is_fixed_;
  const HeldSites held_;
  State state_;
  LimitedMemory memory_;
};

Relaxation::Relaxation(const SaddleVertexGraph& graph, const SurfacePoints& sites,
                       const CentroidalVoronoiOptions& options, const JobStage& stage)
    : graph_(graph),
      options_(options),
      rings_(graph, options.threads),
      integrals_(graph, rings_, options.density, options.threads),
      is_fixed_(sites.size(), 0),
      held_(graph.mesh(), options.curves, options.held, sites.size()) {
  for (const Index site : options.fixed) is_fixed_[site] = 1;
  SurfacePoints start = sites;
  std::vector<double> along = held_.bring(start);
  state_ = evaluate(std::move(start), std::move(along), stage);
  while (revive_empty_cells(stage)) {}
}

State Relaxation::evaluate(SurfacePoints sites, std::vector<double> along, const JobStage& stage) {
  State state;
  state.sites = std::move(sites);
  state.along = std::move(along);
  state.claims = spare_ ? std::move(spare_) : std::make_unique<CellClaims>(graph_, rings_, options_.threads);
  state.claims->find(state.sites, reaches(state.sites), stage.part(0, 0.8));
  state.moments = integrals_.moments(*state.claims, stage);
  for (const CellMoments& cell : state.moments) state.energy += cell.energy;
  return state;
}

/// Takes the better of two states; the other's memory is for the next.
void Relaxation::accept(State next) {
  spare_ = std::move(state_.claims);
  state_ = std::move(next);
}

/// How far sites may own something: somewhat farther than before, and than they have moved. None for the first cells.
std::vector<double> Relaxation::reaches(const SurfacePoints& sites) const {
  constexpr double k_growth = 1.1;
  if (!state_.claims) return {};
  const Mesh& mesh = graph_.mesh();
  std::vector<double> reaches(sites.size());
  for (Index i = 0; i < static_cast<Index>(sites.size()); ++i) {
    const double reach = state_.claims->reach(i);
    const double moved = (position(mesh, sites[i]) - position(mesh, state_.sites[i])).norm();
    reaches[i] = reach > 0 ? k_growth * (reach + moved) : std::numeric_limits<double>::infinity();
  }
  return reaches;
}

double Relaxation::mass() const {
  double sum = 0;
  for (Index face = 0; face < graph_.mesh().face_count(); ++face) {
    const double area = graph_.mesh().face_area(face);
    const Triangle& t = graph_.mesh().triangles()[face];
    if (options_.density.empty())
      sum += area;
    else
      sum += area * (options_.density[t[0]] + options_.density[t[1]] + options_.density[t[2]]) / 3;
  }
  return sum;
}

/// Puts sites without a cell into the cells with the most energy, one each. False when there is nothing to do.
bool Relaxation::revive_empty_cells(const JobStage& stage) {
  std::vector<Index> empty, rich;
  for (Index i = 0; i < static_cast<Index>(state_.moments.size()); ++i) {
    if (state_.moments[i].area > 0)
      rich.push_back(i);
    else if (!is_fixed_[i] && !held_.is_held(i))
      empty.push_back(i);
  }
  if (empty.empty()) return false;
  std::sort(rich.begin(), rich.end(), [&](Index a, Index b) {
    const double of_a = state_.moments[a].energy, of_b = state_.moments[b].energy;
    return of_a != of_b ? of_a > of_b : a < b;
  });
  SurfacePoints sites = state_.sites;
  for (std::size_t i = 0; i < std::min(empty.size(), rich.size()); ++i) sites[empty[i]] = far_place(rich[i]);
  State next = evaluate(std::move(sites), state_.along, stage);
  if (!(next.energy < state_.energy)) {  // nothing is far enough to be told apart
    spare_ = std::move(next.claims);
    return false;
  }
  accept(std::move(next));
  memory_.forget();
  return true;
}

/// Far from the site, in its cell: the last of its vertices, else on the way to a corner of its face.
SurfacePoint Relaxation::far_place(Index site) const {
  const auto nodes = state_.claims->maps().nodes(site);
  if (!nodes.empty()) {
    const Index farthest = graph_.vertex_of(nodes.back());
    if (vertex_at(graph_.mesh(), state_.sites[site]) != farthest) return at_vertex(graph_.mesh(), farthest);
  }
  SurfacePoint place = state_.sites[site];
  const int corner = place.barycentric[0] < place.barycentric[1] ? 0 : 1;
  place.barycentric = 0.5 * (place.barycentric + Vec3::Unit(corner));
  return place;
}

bool Relaxation::advance(const JobStage& stage) {
  const TangentField slope = gradient(state_);
  if (options_.method == RelaxationMethod::lbfgs && !memory_.empty()) {
    if (advance_by(quasi_newton_direction(slope), slope, stage)) return true;
    memory_.forget();
  }
  return advance_by(lloyd_direction(), slope, stage);
}

/// Takes the first of shorter and shorter steps that lowers the energy by a share of what its slope promises.
bool Relaxation::advance_by(const TangentField& direction, const TangentField& slope, const JobStage& stage) {
  constexpr double k_least_share = 1e-4;
  constexpr int k_most_halvings = 6;
  const double promise = dot(slope, direction);
  if (!(promise < 0)) return false;
  double length = 1;
  for (int halving = 0; halving <= k_most_halvings; ++halving, length /= 2) {
    TangentField steps = direction;
    for (Vec2& step : steps) step *= length;
    Moved moved = move_sites(graph_.mesh(), state_.sites, steps, options_.threads);
    std::vector<double> along = held_.move(state_.along, state_.sites, steps, moved);
    State next = evaluate(moved.sites, std::move(along), stage);
    if (!(next.energy <= state_.energy + k_least_share * length * promise)) {
      spare_ = std::move(next.claims);
      continue;
    }
    if (options_.method == RelaxationMethod::lbfgs) {
      TangentField before = slope, change = gradient(next);
      transport(moved, before);
      for (std::size_t i = 0; i < change.size(); ++i) change[i] -= before[i];
      memory_.add(moved, std::move(change));
    }
    accept(std::move(next));
    revive_empty_cells(stage);
    return true;
  }
  return false;
}

/// Of the energy by the sites' places: minus twice the first moment. Fixed sites have none.
TangentField Relaxation::gradient(const State& state) const {
  TangentField field(state.sites.size(), Vec2::Zero());
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (!is_fixed_[i]) field[i] = -2 * state.moments[i].moment;
  }
  held_.project(state.along, state.sites, field);
  return field;
}

/// To the centre of each cell. A cell without mass (no density, or empty) keeps its site.
TangentField Relaxation::lloyd_direction() const {
  TangentField field(state_.sites.size(), Vec2::Zero());
  for (std::size_t i = 0; i < field.size(); ++i) {
    const CellMoments& cell = state_.moments[i];
    if (!is_fixed_[i] && cell.mass > 0) field[i] = cell.moment / cell.mass;
  }
  held_.project(state_.along, state_.sites, field);
  return field;
}

TangentField Relaxation::quasi_newton_direction(const TangentField& slope) const {
  std::vector<double> stiffness;
  for (const CellMoments& cell : state_.moments) stiffness.push_back(2 * cell.mass);
  TangentField field = memory_.direction(slope, stiffness);
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (is_fixed_[i]) field[i].setZero();
  }
  held_.project(state_.along, state_.sites, field);
  shorten(field);
  return field;
}

/// No site leaves its cell: twice the mean squared distance is the squared radius of a disk.
void Relaxation::shorten(TangentField& direction) const {
  for (std::size_t i = 0; i < direction.size(); ++i) {
    const CellMoments& cell = state_.moments[i];
    if (!(cell.mass > 0)) continue;
    const double radius = std::sqrt(2 * std::max(cell.energy, 0.0) / cell.mass), length = direction[i].norm();
    if (length > radius) direction[i] *= radius / length;
  }
}

/// Small falls, one after the other, that end a run. A quasi-Newton step may be poor and the next one good.
int patience(RelaxationMethod method) { return method == RelaxationMethod::lbfgs ? 3 : 1; }

void show(const Relaxation& relaxation, const CentroidalVoronoiOptions& options, const CentroidalVoronoi& result) {
  if (options.watch) options.watch->show({relaxation.state().sites, result.iterations, relaxation.state().energy});
}

void relax(Relaxation& relaxation, const CentroidalVoronoiOptions& options, const JobStage& stage,
           CentroidalVoronoi& result) {
  const double part = 1.0 / (options.max_iterations + 1);
  int small_falls = 0;
  while (result.iterations < options.max_iterations) {
    const JobStage step =
        stage.part((result.iterations + 1) * part, (result.iterations + 2) * part,
                   message("Relaxing cells, step ", result.iterations + 1, " of ", options.max_iterations));
    if (!relaxation.advance(step)) {
      result.converged = true;
      result.stop_reason = "no step lowers the energy";
      return;
    }
    const double energy = relaxation.state().energy, fall = result.energy.back() - energy;
    result.energy.push_back(energy);
    ++result.iterations;
    show(relaxation, options, result);
    small_falls = fall <= options.tolerance * energy ? small_falls + 1 : 0;
    if (small_falls < patience(options.method)) continue;
    result.converged = true;
    result.stop_reason = "tolerance";
    return;
  }
  result.stop_reason = "max_iterations";
}

/// Sites on the curves and others, relaxed. Where the cell of a free site reaches across a curve, the site is put onto
/// it, and all are relaxed again: first a few steps, after which most such cells are known.
CentroidalVoronoi relax_on_curves(const SaddleVertexGraph& graph, Index count, std::uint64_t seed,
                                  const CentroidalVoronoiOptions& options, const JobStage& stage) {
  constexpr int k_first_iterations = 10, k_most_rounds = 5;
  const Mesh& mesh = graph.mesh();
  const HeldSites checked(mesh, options.curves, {}, 0);
  HeldStart start = held_start(mesh, count, options.curves, options.density, seed);
  std::vector<Index> fixed(options.fixed.begin(), options.fixed.end());
  fixed.insert(fixed.end(), start.fixed.begin(), start.fixed.end());
  CentroidalVoronoiOptions on_curves = options;
  on_curves.fixed = fixed;
  for (int round = 0;; ++round) {
    on_curves.max_iterations =
        round == 0 ? std::min(options.max_iterations, k_first_iterations) : options.max_iterations;
    on_curves.held = start.held;
    const JobStage part = stage.part(1 - std::pow(0.5, round), 1 - std::pow(0.5, round + 1));
    CentroidalVoronoi result = relax_sites(graph, start.sites, on_curves, part);
    if (result.stop_reason == k_cancelled || options.max_iterations == 0 || round == k_most_rounds) return result;
    start.sites = result.sites;
    const bool changed = hold_stray_sites(mesh, result.cells, options.curves, fixed, start.sites, start.held);
    if (!changed && on_curves.max_iterations == options.max_iterations) return result;
  }
}

CentroidalVoronoi relax_count(const SaddleVertexGraph& graph, Index count, RelaxationStart start, std::uint64_t seed,
                              const CentroidalVoronoiOptions& options, const JobStage& stage) {
  constexpr double k_start = 0.4;  // coarse cells take nearly as long as fine ones, but few iterations
  constexpr int k_long_run = 50;
  if (!options.curves.empty()) return relax_on_curves(graph, count, seed, options, stage);
  const bool coarse = start == RelaxationStart::automatic ? options.max_iterations >= k_long_run
                                                          : start == RelaxationStart::coarse_to_fine;
  if (!coarse || options.max_iterations == 0) {
    return relax_sites(graph, initial_sites(graph.mesh(), count, options.density, seed), options, stage);
  }
  return relax_sites(graph, coarse_to_fine_sites(graph, count, options, seed, stage.part(0, k_start)), options,
                     stage.part(k_start, 1));
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

SurfacePoints initial_sites(const Mesh& mesh, Index count, std::span<const double> density, std::uint64_t seed) {
  check_count(mesh, count);
  return sample(mesh, {.count = count, .density = density, .seed = seed, .one_per_component = true});
}

CentroidalVoronoi centroidal_voronoi(const SaddleVertexGraph& graph, const SurfacePoints& sites,
                                     const CentroidalVoronoiOptions& options, Job* job) {
  if (options.starts > 1) throw InputError("starts: wanted 1 where the sites are given; others are for a count");
  return relax_sites(graph, sites, options, JobStage(job, "Finding cells"));
}

CentroidalVoronoi centroidal_voronoi(const SaddleVertexGraph& graph, Index count, RelaxationStart start,
                                     std::uint64_t seed, const CentroidalVoronoiOptions& options, Job* job) {
  check_options(graph.mesh(), options);
  check_count(graph.mesh(), count);
  const JobStage stage(job, "Finding cells");
  if (!options.held.empty()) throw InputError("held: wanted sites to go with it, got a count");
  CentroidalVoronoi best;
  for (int i = 0; i < options.starts; ++i) {
    const double part = 1.0 / options.starts;
    CentroidalVoronoi found = relax_count(graph, count, start, seed + static_cast<std::uint64_t>(i), options,
                                          stage.part(i * part, (i + 1) * part));
    const bool was_cancelled = found.stop_reason == k_cancelled;
    if (i == 0 || found.energy.back() < best.energy.back()) best = std::move(found);
    if (!was_cancelled) continue;
    best.stop_reason = k_cancelled;
    break;
  }
  return best;
}

CentroidalVoronoi relax_sites(const SaddleVertexGraph& graph, const SurfacePoints& sites,
                              const CentroidalVoronoiOptions& options, const JobStage& stage) {
  check_sites(graph.mesh(), sites);
  check_options(graph.mesh(), options);
  check_fixed(options, sites);
  const double part = 1.0 / (options.max_iterations + 1);
  Relaxation relaxation(graph, sites, options, stage.part(0, part));
  CentroidalVoronoi result;
  result.energy.push_back(relaxation.state().energy);
  show(relaxation, options, result);
  try {
    relax(relaxation, options, stage, result);
  } catch (const Cancelled&) {
    if (!options.return_when_cancelled) throw;
    result.stop_reason = k_cancelled;
  }
  const State& best = relaxation.state();
  const JobStage last = options.return_when_cancelled ? JobStage() : stage;
  result.sites = best.sites;
  result.held.assign(options.held.begin(), options.held.end());
  const ClaimsOfCells claims(*best.claims);
  result.cells = make_diagram(CellComplex(claims, options.threads, last), best.sites, last);
  constexpr double k_hexagon = 5 / (36 * 1.7320508075688772);
  const double mass = relaxation.mass();
  result.normalised_energy = best.energy * static_cast<double>(sites.size()) / (2 * k_hexagon * mass * mass);
  if (!options.return_when_cancelled) stage.update(1);
  return result;
}

}  // namespace saddleback
