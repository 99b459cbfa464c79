#include "tessellation/relaxation/relaxation.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace saddleback {

Relaxation::Relaxation(const SaddleVertexGraph& graph, const SurfacePoints& sites,
                       const CentroidalVoronoiOptions& options, const JobStage& stage)
    : graph_(graph),
      options_(options),
      cells_(options.cache, CachedCells::relaxed, graph, options.density, options.threads, options.cuda_device),
      is_fixed_(sites.size(), 0),
      is_resting_(sites.size(), 0),
      held_(graph.mesh(), options.constraints.curves, options.constraints.held, sites.size()) {
  for (const Index site : options.constraints.fixed) is_fixed_[site] = 1;
  SurfacePoints start = sites;
  std::vector<double> along = held_.bring(start, stage);
  if (held_.any()) check_sites(graph.mesh(), start, "once held ones are on their curves, ");
  cells_->match(start);
  state_ = evaluate(std::move(start), std::move(along), stage);
  while (revive_empty_cells(stage)) {}
}

RelaxationState Relaxation::evaluate(SurfacePoints sites, std::vector<double> along, const JobStage& stage) {
  RelaxationState state;
  state.sites = std::move(sites);
  state.along = std::move(along);
  state.moments = cells_->find(state.sites, stage);
  for (const CellMoments& cell : state.moments) state.energy += cell.energy;
  return state;
}

void Relaxation::rest(std::vector<std::uint8_t> sites) {
  is_resting_ = std::move(sites);
  memory_.forget();
}

const CellCandidates& Relaxation::cells(const JobStage& stage) {
  const SurfacePoints& last = cells_->candidates().labels().sites();
  const auto same = [](const SurfacePoint& a, const SurfacePoint& b) {
    return a.face == b.face && a.barycentric == b.barycentric;
  };
  if (!cells_->is_whole() || !std::ranges::equal(last, state_.sites, same)) cells_->find(state_.sites, stage);
  cells_->look_farther(stage);
  return cells_->candidates();
}

/// Puts sites without a cell into the cells with the most energy, one each. False when there is nothing to do.
bool Relaxation::revive_empty_cells(const JobStage& stage) {
  std::vector<Index> empty, rich;
  for (Index i = 0; i < static_cast<Index>(state_.moments.size()); ++i) {
    if (state_.moments[i].area > 0)
      rich.push_back(i);
    else if (is_free(i))
      empty.push_back(i);
  }
  if (empty.empty()) return false;
  std::sort(rich.begin(), rich.end(), [&](Index a, Index b) {
    const double of_a = state_.moments[a].energy, of_b = state_.moments[b].energy;
    return of_a != of_b ? of_a > of_b : a < b;
  });
  const CellCandidates& known = cells(stage);
  SurfacePoints sites = state_.sites;
  for (std::size_t i = 0; i < std::min(empty.size(), rich.size()); ++i) sites[empty[i]] = far_place(known, rich[i]);
  RelaxationState next = evaluate(std::move(sites), state_.along, stage);
  if (!(next.energy < state_.energy)) return false;  // no place is far enough from its site to lower it
  state_ = std::move(next);
  memory_.forget();
  return true;
}

/// Far from the site, in its cell: the last of its vertices, else on the way to a corner of its face.
SurfacePoint Relaxation::far_place(const CellCandidates& cells, Index site) const {
  const auto nodes = cells.labels().nodes(site);
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
  is_at_rest_ = false;
  if (options_.method == RelaxationMethod::lbfgs && !memory_.empty()) {
    if (advance_by(quasi_newton_direction(slope), slope, stage)) return true;
    memory_.forget();
  }
  return advance_by(lloyd_direction(), slope, stage);
}

bool Relaxation::advance_to_centers(const JobStage& stage) {
  is_at_rest_ = false;
  return advance_by(lloyd_direction(), gradient(state_), stage);
}

/// Takes the first of shorter and shorter steps that lowers the energy by a share of what its slope promises.
bool Relaxation::advance_by(TangentField direction, const TangentField& slope, const JobStage& stage) {
  constexpr double k_least_share = 1e-4;
  constexpr int k_most_halvings = 6;
  leave_at_rest(direction);
  const double promise = dot(slope, direction);
  if (!(promise < 0)) return false;
  double length = 1;
  for (int halving = 0; halving <= k_most_halvings; ++halving, length /= 2) {
    TangentField steps = direction;
    for (Vec2& step : steps) step *= length;
    Moved moved = move_sites(graph_.mesh(), state_.sites, steps, options_.threads,
                             cells_->candidates().labels().sites_along_curve());
    std::vector<double> along = held_.move(state_.along, state_.sites, steps, moved);
    RelaxationState next = evaluate(moved.sites, std::move(along), stage);
    if (!(next.energy <= state_.energy + k_least_share * length * promise)) continue;
    if (options_.method == RelaxationMethod::lbfgs) {
      TangentField before = slope, change = gradient(next);
      transport(moved, before);
      for (std::size_t i = 0; i < change.size(); ++i) change[i] -= before[i];
      memory_.add(moved, std::move(change));
    }
    state_ = std::move(next);
    revive_empty_cells(stage);
    return true;
  }
  return false;
}

TangentField Relaxation::go(TangentField steps, const JobStage& stage) {
  hold(state_, steps);
  shorten(steps);
  Moved moved = move_sites(graph_.mesh(), state_.sites, steps, options_.threads,
                           cells_->candidates().labels().sites_along_curve());
  std::vector<double> along = held_.move(state_.along, state_.sites, steps, moved);
  go_to(std::move(moved.sites), std::move(along), stage);
  return std::move(moved.steps);
}

void Relaxation::go_to(SurfacePoints sites, std::vector<double> along, const JobStage& stage) {
  state_ = evaluate(std::move(sites), std::move(along), stage);
  memory_.forget();
  revive_empty_cells(stage);
}

/// Returns the gradient of the energy by the sites' places: minus twice the first moment. Fixed sites have none.
TangentField Relaxation::gradient(const RelaxationState& state) const {
  TangentField field(state.sites.size(), Vec2::Zero());
  for (std::size_t i = 0; i < field.size(); ++i) field[i] = -2 * state.moments[i].moment;
  hold(state, field);
  return field;
}

/// A cell without mass (no density, or empty) keeps its site.
TangentField Relaxation::lloyd_direction() const {
  TangentField field(state_.sites.size(), Vec2::Zero());
  for (std::size_t i = 0; i < field.size(); ++i) {
    const CellMoments& cell = state_.moments[i];
    if (cell.mass > 0) field[i] = cell.moment / cell.mass;
  }
  hold(state_, field);
  return field;
}

TangentField Relaxation::quasi_newton_direction(const TangentField& slope) const {
  std::vector<double> stiffness;
  for (const CellMoments& cell : state_.moments) stiffness.push_back(2 * cell.mass);
  TangentField field = memory_.direction(slope, stiffness);
  hold(state_, field);
  shorten(field);
  return field;
}

/// Leaves of a field what fixed and held sites may do.
void Relaxation::hold(const RelaxationState& state, TangentField& field) const {
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (is_fixed_[i] || is_resting_[i]) field[i].setZero();
  }
  held_.project(state.along, state.sites, field);
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

/// Takes out the steps that are shorter than least_move.
void Relaxation::leave_at_rest(TangentField& direction) {
  if (options_.stop.least_move == 0) return;
  is_at_rest_ = true;
  for (std::size_t i = 0; i < direction.size(); ++i) {
    if (direction[i].norm() < options_.stop.least_move * std::sqrt(state_.moments[i].area))
      direction[i].setZero();
    else
      is_at_rest_ = false;
  }
}

}  // namespace saddleback
