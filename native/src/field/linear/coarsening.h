#pragma once
// Smaller matrices that stand for large ones: nodes that vary together become one.

#include <vector>

#include "saddleback/job.h"

#include "field/linear/graph_matrix.h"

namespace saddleback {

/// Holds what coarsening one level decides: node of the next level and phase of the interpolation.
template <class Scalar>
struct Aggregates {
  UnsetArray<Index> of;
  UnsetArray<Scalar> phase;
  UnsetArray<Index> leaders;  ///< the first node of each
  UnsetArray<Index> next;     ///< the node that follows in the same one; k_none after the last

  Index count() const { return static_cast<Index>(leaders.size()); }
  template <class Visit>
  void for_members(Index aggregate, Visit&& visit) const {
    for (Index i = leaders[aggregate]; i != k_none; i = next[i]) visit(i);
  }
};

/// Holds the matrix that stands for another, and which of its nodes do for which.
template <class Scalar>
struct Coarsening {
  Aggregates<Scalar> aggregates;
  GraphMatrix<Scalar> matrix;
};
/// Pairs the nodes, then the pairs. The same for any number of threads. O(nonzeros). \throw Cancelled.
template <class Scalar>
Coarsening<Scalar> coarsened(const GraphMatrix<Scalar>& matrix, const JobStage& stage);

extern template Coarsening<double> coarsened(const GraphMatrix<double>&, const JobStage&);
extern template Coarsening<std::complex<double>> coarsened(const GraphMatrix<std::complex<double>>&, const JobStage&);

}  // namespace saddleback
