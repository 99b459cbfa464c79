#pragma once
// Orders of nodes in which many can be relaxed at the same time.

#include <vector>

#include "saddleback/job.h"

#include "field/linear/graph_matrix.h"

namespace saddleback {

/// Holds an order of nodes in which those of one color come after those of another: ones that are tied to each other
/// differ in color.
struct ColorOrder {
  std::vector<Index> begins;       ///< of each color
  UnsetArray<Index> order, place;  ///< the node at each place; the place of each node
};

/// Colors nodes in their order, each with the first color that is free. The same for any number of threads.
/// O(nonzeros). \throw Cancelled.
template <class Scalar>
ColorOrder order_by_color(const GraphMatrix<Scalar>& matrix, const JobStage& stage);

extern template ColorOrder order_by_color(const GraphMatrix<double>&, const JobStage&);
extern template ColorOrder order_by_color(const GraphMatrix<std::complex<double>>&, const JobStage&);

}  // namespace saddleback
