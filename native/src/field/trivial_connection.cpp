#include "trivial_connection.h"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "support/parallel.h"

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

/// Moves each residual by whole quanta while the energy residual^T inverse residual falls.
void choose_branches(Vector& residual, const Matrix& inverse, double quantum) {
  constexpr int k_sweeps = 20;
  Vector gradient = inverse * residual;
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

std::vector<double> TrivialConnection::turns(std::span<const Index> units, int symmetry, const JobStage& stage) {
  const bool has_handles = !loops_.loops.empty();
  if (has_handles && harmonic_potentials_.empty()) find_harmonic_forms(stage.part(0, 0.8));
  std::vector<double> right(filled_.node_count);
  for (Index i = 0; i < filled_.node_count; ++i) right[i] = filled_.curvature[i] - k_turn * units[i] / symmetry;
  std::vector<double> result =
      potential_turns(solver_->solve(right, {}, k_accuracy, stage.part(has_handles ? 0.8 : 0, 1)));
  if (has_handles) add_harmonic_part(result, symmetry);
  return result;
}

/// Of the form that belongs to a loop: 1 where the loop crosses, less the gradient that makes it free of divergence.
double TrivialConnection::harmonic(std::size_t loop, Index h) const {
  const std::vector<double>& potential = harmonic_potentials_[loop];
  return potential[filled_.node_of[mesh_.from(h)]] - potential[filled_.node_of[mesh_.to(h)]];
}

void TrivialConnection::find_harmonic_forms(const JobStage& stage) {
  const auto count = static_cast<Index>(loops_.loops.size());
  std::vector<std::vector<double>> potentials(count);
  std::atomic<Index> done{0};
  parallel_for(count, 0, 1, [&](Index i, int) {
    std::vector<double> right(filled_.node_count, 0.0);
    for (const Index h : loops_.loops[i]) {
      right[filled_.node_of[mesh_.to(h)]] += connection_.weight[h];
      right[filled_.node_of[mesh_.from(h)]] -= connection_.weight[h];
    }
    const double begin = static_cast<double>(done) / count;
    potentials[i] = solver_->solve(right, {}, k_accuracy, stage.part(begin, begin + 1.0 / count));
    ++done;
  });
  harmonic_potentials_ = std::move(potentials);
  periods_.assign(static_cast<std::size_t>(count) * count, 0.0);
  std::vector<double> crossings(mesh_.halfedge_count(), 0.0);
  for (Index j = 0; j < count; ++j) {
    for (const Index h : loops_.loops[j]) crossings[h] += 1, crossings[mesh_.twin(h)] -= 1;
    for (Index i = 0; i < count; ++i)
      for (const Index h : loops_.loops[i])
        periods_[static_cast<std::size_t>(i) * count + j] += connection_.weight[h] * (crossings[h] + harmonic(j, h));
    for (const Index h : loops_.loops[j]) crossings[h] = crossings[mesh_.twin(h)] = 0;
  }
}

void TrivialConnection::add_harmonic_part(std::vector<double>& turns, int symmetry) const {
  const auto count = static_cast<Eigen::Index>(loops_.loops.size());
  const double quantum = k_turn / symmetry;
  Vector lacking(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    double holonomy = 0;
    for (const Index h : loops_.loops[i]) holonomy += connection_.transport[h] + turns[h];
    lacking[i] = -std::remainder(holonomy, quantum);
  }
  const Eigen::Map<const Matrix> periods(periods_.data(), count, count);
  const Matrix symmetric = 0.5 * (periods + periods.transpose());
  const Matrix inverse = symmetric.ldlt().solve(Matrix::Identity(count, count));
  choose_branches(lacking, inverse, quantum);
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
