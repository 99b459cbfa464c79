#pragma once
// Linear systems of graphs with up to millions of nodes: aggregation multigrid inside conjugate gradients.

#include <utility>
#include <vector>

#include "saddleback/job.h"

#include "field/linear/coarsening.h"
#include "support/threads/parallel.h"

namespace saddleback {

/// Solves with one matrix, prepared once: pairwise aggregation twice a level, K-cycles in single precision as the
/// preconditioner of flexible conjugate gradients in double precision [notay2010]. Of complex matrices the aggregates
/// carry the phase by which neighbors are transported, so that connection Laplacians are coarsened as well as real
/// ones. Scalar: double or std::complex<double>. The smoother is Gauss-Seidel by colors, and sums are those of blocks,
/// so that results do not depend on threads; any number of threads may solve at the same time.
template <class Scalar>
class MultigridSolver {
 public:
  /// \pre positive definite (a shift or one fixed node a component sees to that). O(nonzeros). \throw Cancelled.
  MultigridSolver(GraphMatrix<Scalar> matrix, const JobStage& stage);

  const GraphMatrix<Scalar>& matrix() const { return matrix_; }

  struct Accuracy {
    double residual = 1e-9;  ///< relative to the right side, 2-norm
    int iterations = 300;    ///< the most of them; what is reached then is returned
    double error = 0;        ///< estimated, relative to the solution, both in the energy norm: enough as well
  };
  /// x with matrix x = right; starts from `guess` when it is not empty. About 20 iterations, by several threads (0: all
  /// cores). \throw Cancelled.
  std::vector<Scalar> solve(const std::vector<Scalar>& right, std::vector<Scalar> guess, const Accuracy& accuracy,
                            const JobStage& stage, int threads = 0) const;
  /// Gives the matrix another diagonal near the own one. Nothing is prepared again: iterations then are some more.
  void replace_diagonal(UnsetArray<typename GraphMatrix<Scalar>::Real> diagonal) {
    matrix_.diagonal = std::move(diagonal);
  }

  /// Room for cycles, used again from one to the next.
  class Workspace;
  /// One cycle: about the solution for that right side, of which only the direction counts.
  void precondition(const UnsetArray<Scalar>& right, UnsetArray<Scalar>& result, Workspace& work,
                    const JobStage& stage) const;

 private:
  template <class T>
  struct Narrow {
    using Type = float;
  };
  template <class T>
  struct Narrow<std::complex<T>> {
    using Type = std::complex<float>;
  };
  using Small = typename Narrow<Scalar>::Type;
  using SmallVector = UnsetArray<Small>;

  struct Level {                     ///< its nodes in the order of their colors
    std::vector<Index> colors;       ///< where each begins, and where the last one ends
    UnsetArray<Index> order, place;  ///< the node that is there, and where a node is
    GraphMatrix<Small> matrix;       ///< in each row the columns before the diagonal come first
    UnsetArray<Index> middles;       ///< where in each row the columns after the diagonal begin
    UnsetArray<float> inverse_diagonal;
    UnsetArray<Index> aggregate;               ///< node of the next level; k_none for those that smoothing alone solves
    SmallVector phase;                         ///< of the interpolation from there
    UnsetArray<Index> member_begins, members;  ///< of each aggregate, without the last color's: no residual is there
  };
  struct Vectors {  ///< of one level during a cycle
    SmallVector right, solution, residual, rest, first, first_image, second;
  };

  static Level make_level(const GraphMatrix<Scalar>& matrix, const JobStage& stage);
  static void tie(Level& fine, const Level& coarse, const Aggregates<Scalar>& aggregates);
  void coarsen(const JobStage& stage);
  void factor_coarsest(const GraphMatrix<Scalar>& matrix);
  void cycle(std::size_t level, const SmallVector& right, SmallVector& solution, Workspace& work,
             const JobStage& stage) const;
  void solve_coarsest(const SmallVector& right, SmallVector& solution) const;
  void solve_level(std::size_t level, Workspace& work, const JobStage& stage) const;

  GraphMatrix<Scalar> matrix_;
  std::vector<Level> levels_;     ///< the last one is solved directly
  std::vector<Scalar> coarsest_;  ///< its inverse, dense, row by row
};

template <class Scalar>
class MultigridSolver<Scalar>::Workspace {
 public:
  explicit Workspace(int threads = 0) : threads_(thread_count(threads)) {}

 private:
  friend class MultigridSolver<Scalar>;
  int threads_;
  std::vector<Vectors> levels_;
  SmallVector right_, solution_;
};

extern template class MultigridSolver<double>;
extern template class MultigridSolver<std::complex<double>>;

}  // namespace saddleback
