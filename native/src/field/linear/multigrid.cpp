// Aggregation multigrid. Cycles work in single precision: they are bound by memory, and conjugate gradients in double
// precision correct what they get wrong.

#include "field/linear/multigrid.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <type_traits>

namespace saddleback {
namespace {

constexpr Index k_coarsest = 120;         // nodes that a dense inverse is cheap for
constexpr double k_dominant = 10;         // a diagonal larger than this many times its row needs no coarse correction
constexpr double k_stronger = 1 + 1e-9;   // many are equal but for rounding, which must not say who pairs with whom
constexpr double k_weak = 0.5;            // of a node's strongest tie: others say nothing of how it varies
constexpr double k_stalled = 0.9;         // of the nodes left by pairing: weak ties are taken then
constexpr double k_loosest = 4;           // see is_too_loose; 8 in [napov2012]
constexpr double k_enough = 0.25;         // the K-cycle's second step is left out when the first one gains this much
constexpr Index k_nodes_a_check = 32768;  // about a millisecond between looks at the job

/// Holds what coarsening one level decides: node of the next level and phase of the interpolation.
template <class Scalar>
struct Aggregates {
  std::vector<Index> of;
  std::vector<Scalar> phase;
  Index count = 0;
};

/// The interpolation that takes a node's value to its neighbor across an entry of the matrix.
double transported(double) { return 1; }
std::complex<double> transported(const std::complex<double>& entry) { return -std::conj(entry) / std::abs(entry); }

template <class Scalar>
double sum_of_ties(const GraphMatrix<Scalar>& matrix, Index i) {
  double sum = 0;
  for (Index k = matrix.begins[i]; k < matrix.begins[i + 1]; ++k) sum += std::abs(matrix.values[k]);
  return sum;
}

template <class Scalar>
bool needs_no_correction(const GraphMatrix<Scalar>& matrix, Index i) {
  return matrix.diagonal[i] >= k_dominant * sum_of_ties(matrix, i);
}

/// Tells whether Gauss-Seidel on the finer level, on which two nodes have these sums of ties, evens them out so slowly
/// that they must stay apart: two triangles that are tied firmly move together, and their neighbors hardly move them.
/// After the quality of aggregates [napov2012].
bool is_too_loose(double tie, double of_one, double of_other) {
  return of_one * of_other > k_loosest * tie * (of_one + of_other);
}

template <class Scalar>
double strongest_tie(const GraphMatrix<Scalar>& matrix, Index i) {
  double most = 0;
  for (Index k = matrix.begins[i]; k < matrix.begins[i + 1]; ++k)
    most = std::max(most, double(std::abs(matrix.values[k])));
  return most;
}

/// Each node with the free neighbor that it is tied to most, unless either is tied much more to others: who takes a
/// neighbor from its partner leaves that one to take another's, and so on all over the mesh. Those without one join the
/// strongest neighbor's pair. Ties below `weak` of a node's strongest count for nothing. `finer`: sums of the ties that
/// each has on a finer level, to compare with; zeros: pairs may be tied loosely.
template <class Scalar>
Aggregates<Scalar> pair_up(const GraphMatrix<Scalar>& matrix, const std::vector<double>& finer, double weak,
                           const JobStage& stage) {
  constexpr Index k_free = -2;
  Aggregates<Scalar> result{std::vector<Index>(matrix.size(), k_free), std::vector<Scalar>(matrix.size(), Scalar(1))};
  std::vector<double> strongest(matrix.size()), whole;  // `finer` of each aggregate
  for (Index i = 0; i < matrix.size(); ++i) strongest[i] = strongest_tie(matrix, i);
  for (Index i = 0; i < matrix.size(); ++i) {
    if (i % k_nodes_a_check == 0) stage.check();
    if (result.of[i] != k_free) continue;
    if (needs_no_correction(matrix, i)) {
      result.of[i] = k_none;
      continue;
    }
    Index free = k_none, joined = k_none;
    for (Index k = matrix.begins[i]; k < matrix.begins[i + 1]; ++k) {
      const Index j = matrix.columns[k];
      const double strength = std::abs(matrix.values[k]);
      if (strength < weak * strongest[i]) continue;
      if (is_too_loose(strength, finer[i], result.of[j] >= 0 ? whole[result.of[j]] : finer[j])) continue;
      const auto beats = [&](Index other) {
        return other == k_none || strength > k_stronger * std::abs(matrix.values[other]);
      };
      if (result.of[j] == k_free && strength >= weak * strongest[j] && beats(free) && !needs_no_correction(matrix, j))
        free = k;
      if (result.of[j] >= 0 && beats(joined)) joined = k;
    }
    if (free != k_none) {
      const Index j = matrix.columns[free];
      result.of[i] = result.of[j] = result.count++;
      result.phase[j] = transported(matrix.values[free]);
      whole.push_back(finer[i] + finer[j]);
    } else if (joined != k_none) {
      const Index j = matrix.columns[joined];
      result.of[i] = result.of[j];
      whole[result.of[i]] += finer[i];
      result.phase[i] = times(result.phase[j], Scalar(conjugate(transported(matrix.values[joined]))));
    } else {
      result.of[i] = result.count++;
      whole.push_back(finer[i]);
    }
  }
  return result;
}

/// Interpolation^H matrix interpolation.
template <class Scalar>
GraphMatrix<Scalar> galerkin(const GraphMatrix<Scalar>& matrix, const Aggregates<Scalar>& aggregates,
                             const JobStage& stage) {
  std::vector<Index> begins(aggregates.count + 1, 0), members(matrix.size());
  for (const Index a : aggregates.of)
    if (a >= 0) ++begins[a + 1];
  for (Index a = 0; a < aggregates.count; ++a) begins[a + 1] += begins[a];
  std::vector<Index> next(begins.begin(), begins.end() - 1);
  for (Index i = 0; i < matrix.size(); ++i)
    if (aggregates.of[i] >= 0) members[next[aggregates.of[i]]++] = i;

  GraphMatrix<Scalar> coarse;
  coarse.begins.reserve(aggregates.count + 1);
  coarse.diagonal.reserve(aggregates.count);
  coarse.columns.reserve(matrix.columns.size() / 2);
  coarse.values.reserve(matrix.columns.size() / 2);
  std::vector<Index> place(aggregates.count, k_none);  // where the row being made has this column
  for (Index a = 0; a < aggregates.count; ++a) {
    if (a % k_nodes_a_check == 0) stage.check();
    const auto row = static_cast<Index>(coarse.columns.size());
    double diagonal = 0;
    for (Index m = begins[a]; m < begins[a + 1]; ++m) {
      const Index i = members[m];
      diagonal += matrix.diagonal[i];
      for (Index k = matrix.begins[i]; k < matrix.begins[i + 1]; ++k) {
        const Index j = matrix.columns[k], b = aggregates.of[j];
        if (b < 0) continue;
        const Scalar entry = times(times(conjugate(aggregates.phase[i]), matrix.values[k]), aggregates.phase[j]);
        if (b == a) {
          diagonal += std::real(entry);
        } else if (place[b] >= row) {
          coarse.values[place[b]] += entry;
        } else {
          place[b] = static_cast<Index>(coarse.columns.size());
          coarse.columns.push_back(b);
          coarse.values.push_back(entry);
        }
      }
    }
    coarse.diagonal.push_back(diagonal);
    coarse.begins.push_back(static_cast<Index>(coarse.columns.size()));
  }
  return coarse;
}

/// Appends as one step what two steps of pairing do.
template <class Scalar>
void append_step(Aggregates<Scalar>& first, const Aggregates<Scalar>& second) {
  for (std::size_t i = 0; i < first.of.size(); ++i) {
    if (first.of[i] < 0) continue;
    first.phase[i] = times(first.phase[i], second.phase[first.of[i]]);
    first.of[i] = second.of[first.of[i]];
  }
  first.count = second.count;
}

template <class Scalar>
Scalar dot(const std::vector<Scalar>& a, const std::vector<Scalar>& b) {
  Scalar sum(0);
  for (std::size_t i = 0; i < a.size(); ++i) sum += times(conjugate(a[i]), b[i]);
  return sum;
}

template <class Scalar>
double squared_norm(const std::vector<Scalar>& a) {
  double sum = 0;
  for (const Scalar& value : a) sum += static_cast<double>(std::norm(value));
  return sum;
}

/// a += factor b
template <class Scalar>
void add(std::vector<Scalar>& a, Scalar factor, const std::vector<Scalar>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += times(factor, b[i]);
}

}  // namespace

template <class Scalar>
MultigridSolver<Scalar>::MultigridSolver(GraphMatrix<Scalar> matrix, const JobStage& stage)
    : matrix_(std::move(matrix)) {
  coarsen(stage);
}

template <class Scalar>
auto MultigridSolver<Scalar>::make_level(const GraphMatrix<Scalar>& matrix, const JobStage& stage) -> Level {
  Level level;
  level.matrix.begins = matrix.begins;
  level.matrix.columns.resize(matrix.columns.size());
  level.matrix.values.resize(matrix.columns.size());
  level.matrix.diagonal.assign(matrix.diagonal.begin(), matrix.diagonal.end());
  level.middles.reserve(matrix.size());
  for (Index i = 0; i < matrix.size(); ++i) {
    if (i % k_nodes_a_check == 0) stage.check();
    Index low = matrix.begins[i], high = matrix.begins[i + 1];
    for (Index k = matrix.begins[i]; k < matrix.begins[i + 1]; ++k) {
      const Index to = matrix.columns[k] < i ? low++ : --high;
      level.matrix.columns[to] = matrix.columns[k];
      level.matrix.values[to] = Small(matrix.values[k]);
    }
    level.middles.push_back(low);
    level.inverse_diagonal.push_back(Small(static_cast<float>(1 / matrix.diagonal[i])));
  }
  return level;
}

template <class Scalar>
void MultigridSolver<Scalar>::coarsen(const JobStage& stage) {
  GraphMatrix<Scalar> owned;
  const GraphMatrix<Scalar>* matrix = &matrix_;
  while (true) {
    levels_.push_back(make_level(*matrix, stage));
    if (matrix->size() <= k_coarsest) break;
    const std::vector<double> any(matrix->size(), 0.0);
    Aggregates<Scalar> aggregates = pair_up(*matrix, any, k_weak, stage);
    if (aggregates.count > k_stalled * matrix->size()) aggregates = pair_up(*matrix, any, 0, stage);
    GraphMatrix<Scalar> coarse = galerkin(*matrix, aggregates, stage);
    std::vector<double> ties(aggregates.count, 0.0);
    for (Index i = 0; i < matrix->size(); ++i)
      if (aggregates.of[i] >= 0) ties[aggregates.of[i]] += sum_of_ties(*matrix, i);
    const Aggregates<Scalar> second = pair_up(coarse, ties, k_weak, stage);
    coarse = galerkin(coarse, second, stage);
    append_step(aggregates, second);
    levels_.back().aggregate = std::move(aggregates.of);
    levels_.back().phase.assign(aggregates.phase.begin(), aggregates.phase.end());
    owned = std::move(coarse);
    matrix = &owned;
  }
  factor_coarsest(*matrix);
}

template <class Scalar>
void MultigridSolver<Scalar>::factor_coarsest(const GraphMatrix<Scalar>& matrix) {
  using Dense = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Index size = matrix.size();
  Dense dense = Dense::Zero(size, size);
  for (Index i = 0; i < size; ++i) {
    // A hair more than the diagonal: the mode that the matrix hardly sees must not be all rounding.
    dense(i, i) = matrix.diagonal[i] * (1 + 1e-12) + 1e-300;
    for (Index k = matrix.begins[i]; k < matrix.begins[i + 1]; ++k) dense(i, matrix.columns[k]) += matrix.values[k];
  }
  const Dense inverse = dense.ldlt().solve(Dense::Identity(size, size));
  coarsest_.assign(inverse.data(), inverse.data() + inverse.size());
}

/// Gauss-Seidel forward from zero, the correction of the next level, Gauss-Seidel back.
template <class Scalar>
void MultigridSolver<Scalar>::cycle(std::size_t level, const SmallVector& right, SmallVector& solution, Workspace& work,
                                    const JobStage& stage) const {
  stage.check();
  const Level& here = levels_[level];
  const GraphMatrix<Small>& matrix = here.matrix;
  const Index size = matrix.size();
  solution.resize(size);
  if (level + 1 == levels_.size()) {
    for (Index i = 0; i < size; ++i) {
      Scalar sum(0);
      for (Index j = 0; j < size; ++j) sum += times(coarsest_[i * size + j], Scalar(right[j]));
      solution[i] = Small(sum);
    }
    return;
  }
  for (Index i = 0; i < size; ++i) {
    Small sum = right[i];
    for (Index k = matrix.begins[i]; k < here.middles[i]; ++k)
      sum -= times(matrix.values[k], solution[matrix.columns[k]]);
    solution[i] = times(sum, here.inverse_diagonal[i]);
  }
  Vectors& coarse = work.levels_[level + 1];
  coarse.right.assign(levels_[level + 1].matrix.size(), Small(0));
  for (Index i = 0; i < size; ++i) {
    if (here.aggregate[i] < 0) continue;
    // Of the residual only what lies beyond the diagonal is left.
    Small residual(0);
    for (Index k = here.middles[i]; k < matrix.begins[i + 1]; ++k)
      residual -= times(matrix.values[k], solution[matrix.columns[k]]);
    coarse.right[here.aggregate[i]] += times(conjugate(here.phase[i]), residual);
  }
  solve_level(level + 1, work, stage);
  for (Index i = 0; i < size; ++i)
    if (here.aggregate[i] >= 0) solution[i] += times(here.phase[i], coarse.solution[here.aggregate[i]]);
  for (Index i = size - 1; i >= 0; --i)
    solution[i] = times(right[i] - row_sum(matrix, i, solution), here.inverse_diagonal[i]);
}

/// The K-cycle: one or two steps of conjugate gradients, each with a cycle of this level as its preconditioner.
template <class Scalar>
void MultigridSolver<Scalar>::solve_level(std::size_t level, Workspace& work, const JobStage& stage) const {
  Vectors& v = work.levels_[level];
  if (level + 1 == levels_.size()) return cycle(level, v.right, v.solution, work, stage);
  const GraphMatrix<Small>& matrix = levels_[level].matrix;
  cycle(level, v.right, v.first, work, stage);
  multiply(matrix, v.first, v.first_image);
  const auto first_energy = std::real(dot(v.first, v.first_image));
  if (!(first_energy > 0)) {
    v.solution = v.first;
    return;
  }
  const Small first_step = dot(v.first, v.right) / first_energy;
  v.residual = v.right;
  add(v.residual, -first_step, v.first_image);
  v.solution.assign(v.right.size(), Small(0));
  add(v.solution, first_step, v.first);
  if (squared_norm(v.residual) <= k_enough * k_enough * squared_norm(v.right)) return;

  cycle(level, v.residual, v.second, work, stage);
  multiply(matrix, v.second, v.second_image);
  const Small shared = dot(v.first_image, v.second);
  const auto energy = std::real(dot(v.second, v.second_image)) - std::norm(shared) / first_energy;
  if (!(energy > 0)) return;
  const Small second_step = dot(v.second, v.residual) / energy;
  add(v.solution, second_step, v.second);
  add(v.solution, times(-second_step, shared) / first_energy, v.first);
}

template <class Scalar>
void MultigridSolver<Scalar>::precondition(const std::vector<Scalar>& right, std::vector<Scalar>& result,
                                           Workspace& work, const JobStage& stage) const {
  const double size = std::sqrt(squared_norm(right));
  const double scale = size > 0 ? 1 / size : 1;  // single precision has room around 1
  work.levels_.resize(levels_.size());
  work.right_.resize(right.size());
  for (std::size_t i = 0; i < right.size(); ++i) work.right_[i] = Small(right[i] * scale);
  cycle(0, work.right_, work.solution_, work, stage);
  result.resize(right.size());
  for (std::size_t i = 0; i < right.size(); ++i) result[i] = Scalar(work.solution_[i]) / scale;
}

template <class Scalar>
std::vector<Scalar> MultigridSolver<Scalar>::solve(const std::vector<Scalar>& right, std::vector<Scalar> guess,
                                                   const Accuracy& accuracy, const JobStage& stage) const {
  const Index size = matrix_.size();
  std::vector<Scalar> x = std::move(guess), residual = right, step, image(size, Scalar(0)), direction = image;
  if (x.empty()) {
    x.assign(size, Scalar(0));
  } else {
    for (Index i = 0; i < size; ++i) residual[i] -= matrix_.diagonal[i] * x[i] + row_sum(matrix_, i, x);
  }
  Workspace work;
  const double enough = accuracy.residual * accuracy.residual * squared_norm(right), first = squared_norm(residual);
  double norm = first, energy = 1;
  for (int iteration = 0; iteration < accuracy.iterations && norm > enough; ++iteration) {
    if (first > enough) stage.update(std::log(first / norm) / std::log(first / enough));
    precondition(residual, step, work, stage);
    // Flexible: the preconditioner is not the same linear map each time, so that directions are made conjugate to the
    // last one in so many words.
    Scalar shared(0), gain(0);
    for (Index i = 0; i < size; ++i) {
      shared += times(conjugate(image[i]), step[i]);
      gain += times(conjugate(step[i]), residual[i]);
    }
    shared /= energy;
    for (Index i = 0; i < size; ++i) direction[i] = step[i] - times(shared, direction[i]);
    energy = 0;
    for (Index i = 0; i < size; ++i) {
      image[i] = matrix_.diagonal[i] * direction[i] + row_sum(matrix_, i, direction);
      energy += std::real(times(conjugate(direction[i]), image[i]));
    }
    if (!(energy > 0)) break;
    const Scalar length = gain / energy;
    norm = 0;
    for (Index i = 0; i < size; ++i) {
      x[i] += times(length, direction[i]);
      residual[i] -= times(length, image[i]);
      norm += std::norm(residual[i]);
    }
  }
  stage.update(1);
  return x;
}

template class MultigridSolver<double>;
template class MultigridSolver<std::complex<double>>;

}  // namespace saddleback
