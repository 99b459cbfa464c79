// Aggregation multigrid. Cycles work in single precision: they are bound by memory, and conjugate gradients in double
// precision correct what they get wrong.

#include "field/linear/multigrid.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "field/linear/color_order.h"
#include "field/linear/row_blocks.h"

namespace saddleback {
namespace {

constexpr Index k_coarsest = 120;  // nodes that a dense inverse is cheap for
constexpr double k_enough = 0.25;  // the K-cycle's second step is left out when the first one gains this much

template <class Vector>
double squared_norm(const Vector& a, int threads) {
  return sums_of_rows<std::array<double, 1>>(static_cast<Index>(a.size()), threads, [&](Index i, auto& sums) {
    sums[0] += static_cast<double>(std::norm(a[i]));
  })[0];
}

}  // namespace

template <class Scalar>
MultigridSolver<Scalar>::MultigridSolver(GraphMatrix<Scalar> matrix, const JobStage& stage)
    : matrix_(std::move(matrix)) {
  coarsen(stage);
}

template <class Scalar>
auto MultigridSolver<Scalar>::make_level(const GraphMatrix<Scalar>& matrix, const JobStage& stage) -> Level {
  ColorOrder colors = order_by_color(matrix, stage);
  const Index size = matrix.size();
  Level level;
  level.colors = std::move(colors.begins);
  level.order = std::move(colors.order);
  level.place = std::move(colors.place);
  level.matrix.begins.resize(size + 1);
  for (Index i = 0; i < size; ++i) {
    const Index node = level.order[i];
    level.matrix.begins[i + 1] = level.matrix.begins[i] + matrix.begins[node + 1] - matrix.begins[node];
  }
  level.matrix.columns.resize(matrix.columns.size());
  level.matrix.values.resize(matrix.columns.size());
  level.matrix.diagonal.resize(size);
  level.middles.resize(size);
  level.inverse_diagonal.resize(size);
  for_rows(0, size, 0, [&](Index i) {
    const Index node = level.order[i];
    Index low = level.matrix.begins[i], high = level.matrix.begins[i + 1];
    for (Index k = matrix.begins[node]; k < matrix.begins[node + 1]; ++k) {
      const Index column = level.place[matrix.columns[k]], to = column < i ? low++ : --high;
      level.matrix.columns[to] = column;
      level.matrix.values[to] = Small(matrix.values[k]);
    }
    level.middles[i] = low;
    level.matrix.diagonal[i] = static_cast<float>(matrix.diagonal[node]);
    level.inverse_diagonal[i] = static_cast<float>(1 / matrix.diagonal[node]);
  });
  return level;
}

/// Ties a level to the next, in the orders of both.
template <class Scalar>
void MultigridSolver<Scalar>::tie(Level& fine, const Level& coarse, const Aggregates<Scalar>& aggregates) {
  const Index size = fine.matrix.size(), coarse_size = coarse.matrix.size(), last_color = fine.colors.end()[-2];
  fine.aggregate.resize(size);
  fine.phase.resize(size);
  for_rows(0, size, 0, [&](Index i) {
    const Index node = fine.order[i], of = aggregates.of[node];
    fine.aggregate[i] = of < 0 ? k_none : coarse.place[of];
    fine.phase[i] = Small(aggregates.phase[node]);
  });
  fine.member_begins.assign(coarse_size + 1, 0);
  for_rows(0, coarse_size, 0, [&](Index a) {
    aggregates.for_members(coarse.order[a], [&](Index i) {
      if (fine.place[i] < last_color) ++fine.member_begins[a + 1];
    });
  });
  for (Index a = 0; a < coarse_size; ++a) fine.member_begins[a + 1] += fine.member_begins[a];
  fine.members.resize(fine.member_begins.back());
  for_rows(0, coarse_size, 0, [&](Index a) {
    Index at = fine.member_begins[a];
    aggregates.for_members(coarse.order[a], [&](Index i) {
      if (fine.place[i] < last_color) fine.members[at++] = fine.place[i];
    });
  });
}

template <class Scalar>
void MultigridSolver<Scalar>::coarsen(const JobStage& stage) {
  GraphMatrix<Scalar> owned;
  const GraphMatrix<Scalar>* matrix = &matrix_;
  levels_.push_back(make_level(*matrix, stage));
  while (matrix->size() > k_coarsest) {
    Coarsening<Scalar> next = coarsened(*matrix, stage);
    owned = std::move(next.matrix);
    matrix = &owned;
    levels_.push_back(make_level(*matrix, stage));
    tie(levels_.end()[-2], levels_.back(), next.aggregates);
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

/// Gauss-Seidel forward from zero, the correction of the next level, Gauss-Seidel back: one color after the other, the
/// nodes of each at the same time.
template <class Scalar>
void MultigridSolver<Scalar>::cycle(std::size_t level, const SmallVector& right, SmallVector& solution, Workspace& work,
                                    const JobStage& stage) const {
  stage.check();
  const Level& here = levels_[level];
  const GraphMatrix<Small>& matrix = here.matrix;
  const Index size = matrix.size(), last_color = here.colors.end()[-2];
  solution.resize(size);
  if (level + 1 == levels_.size()) return solve_coarsest(right, solution);
  for (std::size_t c = 0; c + 1 < here.colors.size(); ++c)
    for_rows(here.colors[c], here.colors[c + 1], work.threads_, [&](Index i) {
      Small sum = right[i];
      for (Index k = matrix.begins[i]; k < here.middles[i]; ++k)
        sum -= times(matrix.values[k], solution[matrix.columns[k]]);
      solution[i] = sum * here.inverse_diagonal[i];
    });
  // Of the residual only what lies beyond the diagonal is left.
  SmallVector& rest = work.levels_[level].rest;
  rest.resize(last_color);
  for_rows(0, last_color, work.threads_, [&](Index i) {
    Small residual(0);
    for (Index k = here.middles[i]; k < matrix.begins[i + 1]; ++k)
      residual -= times(matrix.values[k], solution[matrix.columns[k]]);
    rest[i] = times(conjugate(here.phase[i]), residual);
  });
  Vectors& coarse = work.levels_[level + 1];
  coarse.right.resize(levels_[level + 1].matrix.size());
  for_rows(0, static_cast<Index>(coarse.right.size()), work.threads_, [&](Index a) {
    Small sum(0);
    for (Index m = here.member_begins[a]; m < here.member_begins[a + 1]; ++m) sum += rest[here.members[m]];
    coarse.right[a] = sum;
  });
  solve_level(level + 1, work, stage);
  for_rows(0, last_color, work.threads_, [&](Index i) {
    if (here.aggregate[i] >= 0) solution[i] += times(here.phase[i], coarse.solution[here.aggregate[i]]);
  });
  for (std::size_t c = here.colors.size() - 1; c-- > 0;)
    for_rows(here.colors[c], here.colors[c + 1], work.threads_,
             [&](Index i) { solution[i] = (right[i] - row_sum(matrix, i, solution)) * here.inverse_diagonal[i]; });
}

template <class Scalar>
void MultigridSolver<Scalar>::solve_coarsest(const SmallVector& right, SmallVector& solution) const {
  const UnsetArray<Index>& order = levels_.back().order;
  const std::size_t size = order.size();
  for (std::size_t i = 0; i < size; ++i) {
    Scalar sum(0);
    for (std::size_t j = 0; j < size; ++j) sum += times(coarsest_[order[i] * size + order[j]], Scalar(right[j]));
    solution[i] = Small(sum);
  }
}

/// The K-cycle: one or two steps of conjugate gradients, each with a cycle of this level as its preconditioner.
template <class Scalar>
void MultigridSolver<Scalar>::solve_level(std::size_t level, Workspace& work, const JobStage& stage) const {
  Vectors& v = work.levels_[level];
  if (level + 1 == levels_.size()) return cycle(level, v.right, v.solution, work, stage);
  const GraphMatrix<Small>& matrix = levels_[level].matrix;
  const Index size = matrix.size();
  cycle(level, v.right, v.first, work, stage);
  v.first_image.resize(size);
  const auto [energy_of_first, gain_of_first] =
      sums_of_rows<std::array<Small, 2>>(size, work.threads_, [&](Index i, auto& sums) {
        v.first_image[i] = row_product(matrix, i, v.first);
        sums[0] += times(conjugate(v.first[i]), v.first_image[i]);
        sums[1] += times(conjugate(v.first[i]), v.right[i]);
      });
  const float first_energy = std::real(energy_of_first);
  if (!(first_energy > 0)) {
    v.solution = v.first;
    return;
  }
  const Small first_step = gain_of_first / first_energy;
  v.residual.resize(size);
  v.solution.resize(size);
  const auto [left, whole] = sums_of_rows<std::array<double, 2>>(size, work.threads_, [&](Index i, auto& sums) {
    v.residual[i] = v.right[i] - times(first_step, v.first_image[i]);
    v.solution[i] = times(first_step, v.first[i]);
    sums[0] += static_cast<double>(std::norm(v.residual[i]));
    sums[1] += static_cast<double>(std::norm(v.right[i]));
  });
  if (left <= k_enough * k_enough * whole) return;

  cycle(level, v.residual, v.second, work, stage);
  const auto [energy_of_second, shared, gain_of_second] =
      sums_of_rows<std::array<Small, 3>>(size, work.threads_, [&](Index i, auto& sums) {
        const Small own = conjugate(v.second[i]);
        sums[0] += times(own, row_product(matrix, i, v.second));
        sums[1] += times(conjugate(v.first_image[i]), v.second[i]);
        sums[2] += times(own, v.residual[i]);
      });
  const float energy = std::real(energy_of_second) - std::norm(shared) / first_energy;
  if (!(energy > 0)) return;
  const Small second_step = gain_of_second / energy, first_part = times(-second_step, shared) / first_energy;
  for_rows(0, size, work.threads_,
           [&](Index i) { v.solution[i] += times(second_step, v.second[i]) + times(first_part, v.first[i]); });
}

template <class Scalar>
void MultigridSolver<Scalar>::precondition(const UnsetArray<Scalar>& right, UnsetArray<Scalar>& result, Workspace& work,
                                           const JobStage& stage) const {
  const double size = std::sqrt(squared_norm(right, work.threads_));
  const double scale = size > 0 ? 1 / size : 1;  // single precision has room around 1
  const UnsetArray<Index>& order = levels_.front().order;
  const auto count = static_cast<Index>(right.size());
  work.levels_.resize(levels_.size());
  work.right_.resize(count);
  for_rows(0, count, work.threads_, [&](Index i) { work.right_[i] = Small(right[order[i]] * scale); });
  cycle(0, work.right_, work.solution_, work, stage);
  result.resize(count);
  for_rows(0, count, work.threads_, [&](Index i) { result[order[i]] = Scalar(work.solution_[i]) / scale; });
}

template <class Scalar>
std::vector<Scalar> MultigridSolver<Scalar>::solve(const std::vector<Scalar>& right, std::vector<Scalar> guess,
                                                   const Accuracy& accuracy, const JobStage& stage, int threads) const {
  threads = thread_count(threads);
  const Index size = matrix_.size();
  std::vector<Scalar> x = std::move(guess);
  UnsetArray<Scalar> residual(size), step, image(size), direction(size);
  const bool is_guessed = !x.empty();
  x.resize(size);
  for_rows(0, size, threads, [&](Index i) {
    residual[i] = is_guessed ? right[i] - row_product(matrix_, i, x) : right[i];
    image[i] = direction[i] = 0;
  });
  Workspace work(threads);
  const double enough = accuracy.residual * accuracy.residual * squared_norm(right, threads);
  const double first = squared_norm(residual, threads);
  double norm = first, energy = 1, size_of_x = 0;  // the latter squared, in the energy norm
  for (int iteration = 0; iteration < accuracy.iterations && norm > enough; ++iteration) {
    if (first > enough) stage.update(std::log(first / norm) / std::log(first / enough));
    precondition(residual, step, work, stage);
    // Flexible: the preconditioner is not the same linear map each time, so that directions are made conjugate to the
    // last one in so many words.
    auto [shared, gain] = sums_of_rows<std::array<Scalar, 2>>(size, threads, [&](Index i, auto& sums) {
      sums[0] += times(conjugate(image[i]), step[i]);
      sums[1] += times(conjugate(step[i]), residual[i]);
    });
    if (std::real(gain) <= accuracy.error * accuracy.error * size_of_x) break;
    shared /= energy;
    for_rows(0, size, threads, [&, last = shared](Index i) { direction[i] = step[i] - times(last, direction[i]); });
    energy = sums_of_rows<std::array<double, 1>>(size, threads, [&](Index i, auto& sums) {
      image[i] = row_product(matrix_, i, direction);
      sums[0] += std::real(times(conjugate(direction[i]), image[i]));
    })[0];
    if (!(energy > 0)) break;
    const Scalar length = gain / energy;
    const auto sums_of_step = sums_of_rows<std::array<double, 2>>(size, threads, [&](Index i, auto& sums) {
      x[i] += times(length, direction[i]);
      residual[i] -= times(length, image[i]);
      sums[0] += std::norm(residual[i]);
      sums[1] += std::real(times(conjugate(x[i]), right[i]));
    });
    norm = sums_of_step[0], size_of_x = sums_of_step[1];
  }
  stage.update(1);
  return x;
}

template class MultigridSolver<double>;
template class MultigridSolver<std::complex<double>>;

}  // namespace saddleback
