// Components are independent problems that share their steps: sums over faces are kept for each of them.

#include "field/smoothing/smooth_powers.h"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <memory>

namespace saddleback {
namespace {

using Complex = std::complex<double>;
using Vector = std::vector<Complex>;
using Solver = MultigridSolver<Complex>;

constexpr int k_steps = 40;
constexpr double k_settled = 1e-4;  // relative change of the energy in one step
/// The preconditioner's share of the area: makes flat components definite, too small to be seen by others.
constexpr double k_shift = 0.05;

/// Rounds of unit length and diffusion after that.
constexpr int k_rounds = 2;
constexpr Solver::Accuracy k_accuracy{.residual = 0.01};  // directions follow; only they are kept

/// A vector, and what the matrix makes of it.
struct Pair {
  Vector value, image;
};

class Minimizer {
 public:
  Minimizer(const Mesh& mesh, const PowerGraph& graph, const JobStage& stage)
      : mesh_(mesh), matrix_(graph_laplacian(mesh.face_count(), graph)), components_(mesh.component_count()) {
    std::vector<double> area(components_, 0.0);
    for (Index f = 0; f < mesh.face_count(); ++f) area[component(f)] += mesh.face_area(f);
    GraphMatrix<Complex> shifted = matrix_;
    mass_.resize(mesh.face_count());
    for (Index f = 0; f < mesh.face_count(); ++f) {
      mass_[f] = mesh.face_area(f) / area[component(f)];
      shifted.diagonal[f] += k_shift * mass_[f];
    }
    solver_ = std::make_unique<Solver>(std::move(shifted), stage);
    energy_.assign(components_, 0.0);
  }

  /// Leaves the eigenvector as the current one.
  void minimize(Vector start, const JobStage& stage) {
    Solver::Workspace work;
    Vector right(start.size());
    for (std::size_t f = 0; f < start.size(); ++f) right[f] = mass_[f] * start[f];
    solver_->precondition(right, current_.value, work, stage);
    multiply(matrix_, current_.value, current_.image);
    normalize();
    for (int step = 0; step < k_steps; ++step) {
      stage.update(static_cast<double>(step) / k_steps);
      Vector residual = current_.image;
      for (std::size_t f = 0; f < residual.size(); ++f)
        residual[f] -= energy_[component(static_cast<Index>(f))] * mass_[f] * current_.value[f];
      solver_->precondition(residual, search_.value, work, stage);
      multiply(matrix_, search_.value, search_.image);
      if (improve(step > 0) < k_settled) break;
    }
  }

  /// The eigenvector is all but zero where the surface bends much, and its directions there are noise. Unit length
  /// everywhere and diffusion over the eigenvector's own scale, by turns, leave the singularities that the surface asks
  /// for [viertel2019].
  Vector even_out(const JobStage& stage) {
    solver_.reset();
    GraphMatrix<Complex> diffusion = matrix_;
    std::vector<double> share(mass_.size());
    for (Index f = 0; f < mesh_.face_count(); ++f) {
      share[f] = std::max(energy_[component(f)], 1.0) * mass_[f];
      diffusion.diagonal[f] += share[f];
    }
    const Solver solver(std::move(diffusion), stage.part(0, 0.1));
    Vector result = std::move(current_.value);
    for (int round = 0; round < k_rounds; ++round) {
      Vector right(result.size());
      for (std::size_t f = 0; f < right.size(); ++f) {
        const double size = std::abs(result[f]);
        right[f] = result[f] *= size > 0 ? 1 / size : 0;
        right[f] *= share[f];
      }
      const JobStage part = stage.part(0.1 + 0.45 * round, 0.55 + 0.45 * round);
      result = solver.solve(right, std::move(result), k_accuracy, part);
    }
    return result;
  }

 private:
  struct Sums {
    std::array<std::array<Complex, 3>, 3> energy{}, mass{};
  };

  Index component(Index face) const { return mesh_.component_of(mesh_.triangles()[face][0]); }

  /// Returns the products of the first `count` of current, search and last.
  std::vector<Sums> all_products(int count) const {
    const std::array<const Pair*, 3> vectors{&current_, &search_, &last_};
    std::vector<Sums> result(components_);
    for (Index f = 0; f < mesh_.face_count(); ++f) {
      Sums& sums = result[component(f)];
      for (int i = 0; i < count; ++i) {
        const Complex left = std::conj(vectors[i]->value[f]);
        for (int j = i; j < count; ++j) {
          sums.energy[i][j] += times(left, vectors[j]->image[f]);
          sums.mass[i][j] += mass_[f] * times(left, vectors[j]->value[f]);
        }
      }
    }
    return result;
  }

  void normalize() {
    const std::vector<Sums> sums = all_products(1);
    for (Index f = 0; f < mesh_.face_count(); ++f) {
      const double scale = 1 / std::sqrt(std::real(sums[component(f)].mass[0][0]));
      current_.value[f] *= scale;
      current_.image[f] *= scale;
    }
    for (Index c = 0; c < components_; ++c)
      energy_[c] = std::real(sums[c].energy[0][0]) / std::real(sums[c].mass[0][0]);
  }

  /// The combination of least energy: its factors for current, search and last.
  static std::array<Complex, 3> best_combination(const Sums& sums, int count) {
    for (; count > 1; --count) {
      Eigen::MatrixXcd energy(count, count), mass(count, count);
      Eigen::VectorXd scale(count);
      for (int i = 0; i < count; ++i) {
        const double own = std::real(sums.mass[i][i]);
        scale[i] = own > 0 ? 1 / std::sqrt(own) : 0;
      }
      if (!(scale.minCoeff() > 0)) continue;
      for (int i = 0; i < count; ++i) {
        for (int j = i; j < count; ++j) {
          energy(i, j) = sums.energy[i][j] * scale[i] * scale[j];
          mass(i, j) = sums.mass[i][j] * scale[i] * scale[j];
          energy(j, i) = std::conj(energy(i, j));
          mass(j, i) = std::conj(mass(i, j));
        }
      }
      // Directions that are nearly the same: one less.
      if (Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd>(mass).eigenvalues()[0] < 1e-10) continue;
      const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXcd> found(energy, mass);
      if (found.info() != Eigen::Success) continue;
      std::array<Complex, 3> result{};
      for (int i = 0; i < count; ++i) result[i] = found.eigenvectors()(i, 0) * scale[i];
      return result;
    }
    return {Complex(1), Complex(0), Complex(0)};
  }

  /// One step; returns the largest relative gain of a component.
  double improve(bool with_last) {
    const int count = with_last ? 3 : 2;
    const std::vector<Sums> sums = all_products(count);
    std::vector<std::array<Complex, 3>> factors(components_);
    for (Index c = 0; c < components_; ++c) factors[c] = best_combination(sums[c], count);
    if (!with_last) {
      last_.value.assign(mass_.size(), Complex(0));
      last_.image = last_.value;
    }
    for (Index f = 0; f < mesh_.face_count(); ++f) {
      const auto& factor = factors[component(f)];
      last_.value[f] = times(factor[1], search_.value[f]) + times(factor[2], last_.value[f]);
      last_.image[f] = times(factor[1], search_.image[f]) + times(factor[2], last_.image[f]);
      current_.value[f] = times(factor[0], current_.value[f]) + last_.value[f];
      current_.image[f] = times(factor[0], current_.image[f]) + last_.image[f];
    }
    const std::vector<double> before = energy_;
    normalize();
    double gain = 0;
    // Against a floor far below any energy that curvature forces: flat components have none.
    for (Index c = 0; c < components_; ++c)
      gain = std::max(gain, (before[c] - energy_[c]) / std::max(energy_[c], 1e-6));
    return gain;
  }

  const Mesh& mesh_;
  GraphMatrix<Complex> matrix_;
  Index components_;
  std::vector<double> mass_;
  std::unique_ptr<Solver> solver_;
  std::vector<double> energy_;
  Pair current_, search_, last_;
};

}  // namespace

std::vector<Complex> smoothest_powers(const Mesh& mesh, const PowerGraph& graph, std::vector<Complex> start,
                                      const JobStage& stage) {
  Minimizer minimizer(mesh, graph, stage.part(0, 0.1));
  minimizer.minimize(std::move(start), stage.part(0.1, 0.6));
  return minimizer.even_out(stage.part(0.6, 1));
}

}  // namespace saddleback
