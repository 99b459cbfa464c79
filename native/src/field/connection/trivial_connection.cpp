#include "field/connection/trivial_connection.h"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "field/connection/sharp_loops.h"
#include "field/linear/row_blocks.h"

namespace saddleback {
namespace {

constexpr double k_turn = 2 * std::numbers::pi;
constexpr MultigridSolver<double>::Accuracy k_accuracy{.residual = 1e-7};

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

/// The Laplacian over nodes named by `node_of`, one of them fixed in each component. That changes no solution whose
/// right side sums to zero: the fixed node's own equation then gives it the value zero.
GraphMatrix<double> node_laplacian(const Mesh& mesh, const SurfaceConnection& connection,
                                   const std::vector<Index>& node_of, Index node_count) {
  std::vector<GraphEdge<double>> edges;
  edges.reserve(mesh.edge_count());
  for (const Index h : inner_edges(mesh))
    edges.push_back({node_of[mesh.from(h)], node_of[mesh.to(h)], connection.weight[h]});
  GraphMatrix<double> result = graph_laplacian(node_count, edges);
  std::vector<bool> fixed(mesh.component_count(), false);
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (fixed[mesh.component_of(v)]) continue;
    fixed[mesh.component_of(v)] = true;
    result.diagonal[node_of[v]] += 1;
  }
  return result;
}

/// Moves each residual by whole quanta while the energy of what it differs from the wanted ones falls, by that matrix.
void choose_branches(Vector& residual, const Vector& wanted, const Eigen::Ref<const Matrix>& inverse, double quantum) {
  constexpr int k_sweeps = 20;
  Vector gradient = inverse * (residual - wanted);
  bool changed = true;
  for (int sweep = 0; changed && sweep < k_sweeps; ++sweep) {
    changed = false;
    for (Eigen::Index i = 0; i < residual.size(); ++i) {
      const double step = -quantum * std::round(gradient[i] / (inverse(i, i) * quantum));
      // Of two equally good branches the one at hand stays.
      if (step == 0 || 2 * step * gradient[i] + step * step * inverse(i, i) > -1e-9 * quantum * quantum * inverse(i, i))
        continue;
      residual[i] += step;
      gradient += step * inverse.col(i);
      changed = true;
    }
  }
}

/// A loop that shall turn by `most` at most; it turns by `turn` now, and by `effect` more for each residual.
struct LoopLimit {
  Vector effect;
  double turn, most;

  double excess(double more) const { return std::pow(std::max(0.0, std::abs(turn + more) - most), 2); }
};

/// Moves one or two residuals at a time by a quantum, the best move first, while loops turn too far that need not, or
/// the energy falls and no loop turns farther.
void ease_loops(Vector& residual, const Vector& wanted, const Eigen::Ref<const Matrix>& inverse, double quantum,
                std::vector<LoopLimit>& limits) {
  constexpr int k_moves = 200;
  constexpr double k_priority = 1e4;  // of loops over energy
  const Eigen::Index count = residual.size();
  const double weight = k_priority * inverse.diagonal().maxCoeff(), least = 1e-9 * quantum * quantum * weight;
  for (int move = 0; move < k_moves; ++move) {
    const Vector gradient = inverse * (residual - wanted);
    double best = -least;
    Eigen::Index best_i = -1, best_j = -1;
    double step_i = 0, step_j = 0;
    const auto consider = [&](Eigen::Index i, double di, Eigen::Index j, double dj) {
      double gain = 2 * (di * gradient[i] + dj * gradient[j]) + di * di * inverse(i, i) + dj * dj * inverse(j, j) +
                    2 * di * dj * inverse(i, j);
      for (const LoopLimit& limit : limits)
        gain += weight * (limit.excess(di * limit.effect[i] + dj * limit.effect[j]) - limit.excess(0));
      if (gain < best) best = gain, best_i = i, best_j = j, step_i = di, step_j = dj;
    };
    for (Eigen::Index i = 0; i < count; ++i)
      for (const double di : {-quantum, quantum}) {
        consider(i, di, i, 0);
        for (Eigen::Index j = 0; j < i; ++j)
          for (const double dj : {-quantum, quantum}) consider(i, di, j, dj);
      }
    if (best_i < 0) return;
    residual[best_i] += step_i;
    residual[best_j] += step_j;
    for (LoopLimit& limit : limits) limit.turn += step_i * limit.effect[best_i] + step_j * limit.effect[best_j];
  }
}

}  // namespace

TrivialConnection::TrivialConnection(const Mesh& mesh, const SurfaceConnection& connection, const FilledSurface& filled,
                                     const DualLoops& loops, const JobStage& stage)
    : mesh_(mesh),
      connection_(connection),
      filled_(filled),
      loops_(loops),
      solver_(std::make_unique<MultigridSolver<double>>(
          node_laplacian(mesh, connection, filled.node_of, filled.node_count), stage)) {}

std::vector<double> TrivialConnection::potential_turns(const std::vector<double>& potential) const {
  std::vector<double> result(mesh_.halfedge_count(), 0.0);
  for (Index h = 0; h < mesh_.halfedge_count(); ++h) {
    if (mesh_.twin(h) == k_none) continue;
    const double drop = potential[filled_.node_of[mesh_.from(h)]] - potential[filled_.node_of[mesh_.to(h)]];
    result[h] = connection_.weight[h] * drop;
  }
  return result;
}

std::vector<double> TrivialConnection::turns(std::span<const Index> units, int symmetry, std::span<const double> given,
                                             const std::vector<std::vector<Index>>& gentle, const JobStage& stage) {
  const bool has_handles = !loops_.loops.empty();
  if (has_handles && harmonic_potentials_.empty()) find_harmonic_forms(stage.part(0, 0.8));
  std::vector<double> right(filled_.node_count);
  for (Index i = 0; i < filled_.node_count; ++i) right[i] = filled_.curvature[i] - k_turn * units[i] / symmetry;
  std::vector<double> result =
      potential_turns(solver_->solve(right, {}, k_accuracy, stage.part(has_handles ? 0.8 : 0, 1)));
  if (has_handles) add_harmonic_part(result, symmetry, given, gentle);
  return result;
}

/// Returns the value of the form that belongs to a loop: 1 where the loop crosses, less the gradient that makes it free
/// of divergence.
double TrivialConnection::harmonic(std::size_t loop, Index h) const {
  const std::vector<double>& potential = harmonic_potentials_[loop];
  return potential[filled_.node_of[mesh_.from(h)]] - potential[filled_.node_of[mesh_.to(h)]];
}

void TrivialConnection::find_harmonic_forms(const JobStage& stage) {
  const auto count = static_cast<Index>(loops_.loops.size());
  std::vector<std::vector<double>> potentials(count);
  std::atomic<Index> done{0};
  const NestedThreads threads(count);
  parallel_for(count, threads.tasks, 1, [&](Index i, int) {
    std::vector<double> right(filled_.node_count, 0.0);
    for (const Index h : loops_.loops[i]) {
      right[filled_.node_of[mesh_.to(h)]] += connection_.weight[h];
      right[filled_.node_of[mesh_.from(h)]] -= connection_.weight[h];
    }
    const double begin = static_cast<double>(done) / count;
    potentials[i] = solver_->solve(right, {}, k_accuracy, stage.part(begin, begin + 1.0 / count), threads.rows);
    ++done;
  });
  harmonic_potentials_ = std::move(potentials);
  Matrix periods = Matrix::Zero(count, count);
  std::vector<double> crossings(mesh_.halfedge_count(), 0.0);
  for (Index j = 0; j < count; ++j) {
    for (const Index h : loops_.loops[j]) crossings[h] += 1, crossings[mesh_.twin(h)] -= 1;
    for (Index i = 0; i < count; ++i)
      for (const Index h : loops_.loops[i]) periods(i, j) += connection_.weight[h] * (crossings[h] + harmonic(j, h));
    for (const Index h : loops_.loops[j]) crossings[h] = crossings[mesh_.twin(h)] = 0;
  }
  const Matrix symmetric = 0.5 * (periods + periods.transpose());
  const Matrix inverse = symmetric.ldlt().solve(Matrix::Identity(count, count));
  inverse_periods_.assign(inverse.data(), inverse.data() + inverse.size());
}

std::vector<double> TrivialConnection::windings_of(const std::vector<Index>& loop) const {
  const auto count = static_cast<Eigen::Index>(loops_.loops.size());
  Vector periods = Vector::Zero(count);
  for (Eigen::Index j = 0; j < count; ++j) {
    for (const Index h : loop) periods[j] += connection_.weight[h] * harmonic(j, h);
    for (const Index across : loops_.loops[j])
      for (const Index h : loop)
        periods[j] += connection_.weight[h] * ((h == across ? 1 : 0) - (mesh_.twin(h) == across ? 1 : 0));
  }
  const Vector result = (Eigen::Map<const Matrix>(inverse_periods_.data(), count, count) * periods).array().round();
  return {result.begin(), result.end()};
}

/// Returns what the harmonic part of a turning adds up to along each loop: its products with the harmonic forms.
std::vector<double> TrivialConnection::harmonic_part(std::span<const double> given) const {
  std::vector<double> result(loops_.loops.size(), 0.0);
  if (given.empty()) return result;
  for (std::size_t i = 0; i < result.size(); ++i) {
    for (const Index h : loops_.loops[i]) result[i] += given[h];
    for (const Index h : inner_edges(mesh_)) result[i] += given[h] * harmonic(i, h);
  }
  return result;
}

void TrivialConnection::add_harmonic_part(std::vector<double>& turns, int symmetry, std::span<const double> given,
                                          const std::vector<std::vector<Index>>& gentle) const {
  const auto count = static_cast<Eigen::Index>(loops_.loops.size());
  const double quantum = k_turn / symmetry;
  const std::vector<double> near = harmonic_part(given);
  const Vector wanted = Eigen::Map<const Vector>(near.data(), count);
  Vector lacking(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    double holonomy = 0;
    for (const Index h : loops_.loops[i]) holonomy += connection_.transport[h] + turns[h];
    lacking[i] = wanted[i] - std::remainder(holonomy + wanted[i], quantum);
  }
  const Eigen::Map<const Matrix> inverse(inverse_periods_.data(), count, count);
  choose_branches(lacking, wanted, inverse, quantum);
  std::vector<LoopLimit> limits;
  for (const std::vector<Index>& loop : gentle) {
    const std::vector<double> windings = windings_of(loop);
    const Vector effect = Eigen::Map<const Vector>(windings.data(), count);
    double turn = effect.dot(lacking);
    for (const Index h : loop) turn += turns[h];
    limits.push_back({effect, turn, k_told_share * std::numbers::pi / symmetry * static_cast<double>(loop.size())});
  }
  if (!limits.empty()) ease_loops(lacking, wanted, inverse, quantum, limits);
  const Vector shares = inverse * lacking;
  std::vector<double> potential(filled_.node_count, 0.0);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Index node = 0; node < filled_.node_count; ++node)
      potential[node] += shares[i] * harmonic_potentials_[i][node];
    for (const Index h : loops_.loops[i]) {
      turns[h] += connection_.weight[h] * shares[i];
      turns[mesh_.twin(h)] -= connection_.weight[h] * shares[i];
    }
  }
  const std::vector<double> rest = potential_turns(potential);
  for (std::size_t h = 0; h < turns.size(); ++h) turns[h] += rest[h];
}

std::vector<double> TrivialConnection::best_units(std::span<const Index> units, const std::vector<Index>& free,
                                                  int symmetry, const JobStage& stage) const {
  // Least turning has the same potential at all free nodes of a component: one node in their place.
  std::vector<Index> merged_into(filled_.node_count, k_none), first(filled_.components.size(), k_none);
  for (const Index node : free) {
    Index& target = first[filled_.component_of[node]];
    if (target == k_none) target = node;
    merged_into[node] = target;
  }
  std::vector<Index> node_of = filled_.node_of;
  for (Index& node : node_of)
    if (merged_into[node] != k_none) node = merged_into[node];
  std::vector<double> right(filled_.node_count, 0.0), total(filled_.components.size(), 0.0);
  for (Index i = 0; i < filled_.node_count; ++i)
    if (merged_into[i] == k_none) right[i] = filled_.curvature[i] - k_turn * units[i] / symmetry;
  for (Index i = 0; i < filled_.node_count; ++i) total[filled_.component_of[i]] += right[i];
  for (std::size_t c = 0; c < first.size(); ++c)
    if (first[c] != k_none) right[first[c]] = -total[c];

  GraphMatrix<double> matrix = node_laplacian(mesh_, connection_, node_of, filled_.node_count);
  for (double& diagonal : matrix.diagonal)
    if (diagonal == 0) diagonal = 1;  // merged into another
  std::vector<double> potential =
      MultigridSolver<double>(std::move(matrix), stage.part(0, 0.3)).solve(right, {}, {.residual = 1e-7}, stage);
  for (const Index node : free) potential[node] = potential[merged_into[node]];
  std::vector<double> result(free.size());
  std::vector<Index> place(filled_.node_count, k_none);
  for (std::size_t i = 0; i < free.size(); ++i) {
    place[free[i]] = static_cast<Index>(i);
    result[i] = symmetry * filled_.curvature[free[i]] / k_turn;
  }
  const std::vector<double> turns = potential_turns(potential);
  for (Index h = 0; h < mesh_.halfedge_count(); ++h)
    if (const Index i = place[filled_.node_of[mesh_.to(h)]]; i != k_none) result[i] += symmetry * turns[h] / k_turn;
  return result;
}

}  // namespace saddleback
