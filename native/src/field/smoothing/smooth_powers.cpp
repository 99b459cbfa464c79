// Components are independent problems that share their steps: sums over faces are kept for each of them.

#include "field/smoothing/smooth_powers.h"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <memory>

#include "field/linear/row_blocks.h"

namespace saddleback {
namespace {

using Complex = std::complex<double>;
using Vector = UnsetArray<Complex>;
using Solver = MultigridSolver<Complex>;

constexpr int k_steps = 40;
constexpr double k_settled = 1e-4;  // relative change of the energy in one step
/// The preconditioner's share of the area: makes flat components definite, too small to be seen by others.
constexpr double k_shift = 0.05;

/// Rounds of unit length and diffusion after that.
constexpr int k_rounds = 2;
constexpr Solver::Accuracy k_accuracy{.residual = 1e-3, .error = 0.01};  // directions follow; only they are kept

/// A vector, and what the matrix makes of it.
struct Pair {
  Vector value, image;
};

class Minimizer {
 public:
  Minimizer(const Mesh& mesh, const PowerGraph& graph, const JobStage& stage)
      : mesh_(mesh), components_(mesh.component_count()) {
    std::vector<double> area(components_, 0.0);
    for (Index f = 0; f < mesh.face_count(); ++f) area[component(f)] += mesh.face_area(f);
    GraphMatrix<Complex> shifted = power_matrix(mesh, graph, std::vector<double>(mesh.face_count(), 0.0));
    diagonal_ = shifted.diagonal;
    mass_.resize(mesh.face_count());
    for_faces([&](Index f) {
      mass_[f] = mesh.face_area(f) / area[component(f)];
      shifted.diagonal[f] += k_shift * mass_[f];
    });
    list_stretches();
    solver_ = std::make_unique<Solver>(std::move(shifted), stage);
    energy_.assign(components_, 0.0);
  }

  /// Leaves the eigenvector as the current one.
  void minimize(const std::vector<Complex>& start, const JobStage& stage) {
    Solver::Workspace work;
    Vector right(start.size());
    for_faces([&](Index f) { right[f] = mass_[f] * start[f]; });
    solver_->precondition(right, current_.value, work, stage);
    take_image(current_);
    normalize();
    for (int step = 0; step < k_steps; ++step) {
      stage.update(static_cast<double>(step) / k_steps);
      for_faces([&](Index f) { right[f] = current_.image[f] - energy_[component(f)] * mass_[f] * current_.value[f]; });
      solver_->precondition(right, search_.value, work, stage);
      take_image(search_);
      if (improve(step > 0) < k_settled) break;
    }
  }

  /// The eigenvector is all but zero where the surface bends much, and its directions there are noise. Unit length
  /// everywhere and diffusion over the eigenvector's own scale, by turns, leave the singularities that the surface asks
  /// for [viertel2019].
  std::vector<Complex> even_out(const JobStage& stage) {
    // No eigenvalue is below the energy: the prepared matrix lacks no more than half, where the energy is not tiny.
    UnsetArray<double> share(mass_.size());
    for_faces([&](Index f) {
      share[f] = std::max(energy_[component(f)], 1.0) * mass_[f];
      diagonal_[f] += share[f];
    });
    solver_->replace_diagonal(std::move(diagonal_));
    std::vector<Complex> result(current_.value.begin(), current_.value.end()), right(result.size());
    for (int round = 0; round < k_rounds; ++round) {
      for_faces([&](Index f) {
        const double size = std::abs(result[f]);
        result[f] *= size > 0 ? 1 / size : 0;
        right[f] = share[f] * result[f];
      });
      const JobStage part = stage.part(0.5 * round, 0.5 * (round + 1));
      result = solver_->solve(right, std::move(result), k_accuracy, part);
    }
    return result;
  }

 private:
  struct Sums {
    std::array<std::array<Complex, 3>, 3> energy{}, mass{};

    void operator+=(const Sums& other) {
      for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j) energy[i][j] += other.energy[i][j], mass[i][j] += other.mass[i][j];
    }
  };

  Index component(Index face) const { return mesh_.component_of(mesh_.triangles()[face][0]); }

  template <class Body>
  void for_faces(Body&& body) const {
    for_rows(0, mesh_.face_count(), 0, body);
  }

  void take_image(Pair& pair) const {
    pair.image.resize(pair.value.size());
    const GraphMatrix<Complex>& ties = solver_->matrix();
    for_faces([&](Index f) { pair.image[f] = diagonal_[f] * pair.value[f] + row_sum(ties, f, pair.value); });
  }

  /// Lists the faces by component, and where among them stretches of one component begin whose sums one thread makes.
  void list_stretches() {
    constexpr Index k_stretch = 4096;
    std::vector<Index> begins(components_ + 1, 0);
    for (Index f = 0; f < mesh_.face_count(); ++f) ++begins[component(f) + 1];
    for (Index c = 0; c < components_; ++c) {
      for (Index begin = 0; begin < begins[c + 1]; begin += k_stretch) stretches_.push_back(begins[c] + begin);
      begins[c + 1] += begins[c];
    }
    stretches_.push_back(mesh_.face_count());
    faces_.resize(mesh_.face_count());
    for (Index f = 0; f < mesh_.face_count(); ++f) faces_[begins[component(f)]++] = f;
  }

  /// Returns the products of the first `count` of current, search and last.
  std::vector<Sums> all_products(int count) const {
    const std::array<const Pair*, 3> vectors{&current_, &search_, &last_};
    std::vector<Sums> parts(stretches_.size() - 1), result(components_);
    parallel_for(static_cast<Index>(parts.size()), 0, 1, [&](Index stretch, int) {
      Sums sums;
      for (Index place = stretches_[stretch]; place < stretches_[stretch + 1]; ++place) {
        const Index f = faces_[place];
        for (int i = 0; i < count; ++i) {
          const Complex left = std::conj(vectors[i]->value[f]);
          for (int j = i; j < count; ++j) {
            sums.energy[i][j] += times(left, vectors[j]->image[f]);
            sums.mass[i][j] += mass_[f] * times(left, vectors[j]->value[f]);
          }
        }
      }
      parts[stretch] = sums;
    });
    for (std::size_t s = 0; s < parts.size(); ++s) result[component(faces_[stretches_[s]])] += parts[s];
    return result;
  }

  void normalize() {
    const std::vector<Sums> sums = all_products(1);
    for_faces([&](Index f) {
      const double scale = 1 / std::sqrt(std::real(sums[component(f)].mass[0][0]));
      current_.value[f] *= scale;
      current_.image[f] *= scale;
    });
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
      last_.value.resize(mass_.size());
      last_.image.resize(mass_.size());
      for_faces([&](Index f) { last_.value[f] = last_.image[f] = 0; });
    }
    for_faces([&](Index f) {
      const auto& factor = factors[component(f)];
      last_.value[f] = times(factor[1], search_.value[f]) + times(factor[2], last_.value[f]);
      last_.image[f] = times(factor[1], search_.image[f]) + times(factor[2], last_.image[f]);
      current_.value[f] = times(factor[0], current_.value[f]) + last_.value[f];
      current_.image[f] = times(factor[0], current_.image[f]) + last_.image[f];
    });
    const std::vector<double> before = energy_;
    normalize();
    double gain = 0;
    // Against a floor far below any energy that curvature forces: flat components have none.
    for (Index c = 0; c < components_; ++c)
      gain = std::max(gain, (before[c] - energy_[c]) / std::max(energy_[c], 1e-6));
    return gain;
  }

  const Mesh& mesh_;
  Index components_;
  UnsetArray<double> mass_, diagonal_;    ///< the matrix is the solver's, but for what that has more on the diagonal
  std::vector<Index> faces_, stretches_;  // see list_stretches
  std::unique_ptr<Solver> solver_;
  std::vector<double> energy_;
  Pair current_, search_, last_;
};

}  // namespace

std::vector<Complex> smoothest_powers(const Mesh& mesh, const PowerGraph& graph, const std::vector<Complex>& start,
                                      const JobStage& stage) {
  Minimizer minimizer(mesh, graph, stage.part(0, 0.1));
  minimizer.minimize(start, stage.part(0.1, 0.6));
  return minimizer.even_out(stage.part(0.6, 1));
}

}  // namespace saddleback
