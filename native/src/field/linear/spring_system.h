#pragma once
// Graphs whose nodes are drawn to given values by springs, or held there.

#include <limits>
#include <vector>

#include "field/linear/graph_matrix.h"

namespace saddleback {

inline constexpr double k_fixed = std::numeric_limits<double>::infinity();

/// The linear system of the equilibrium; what ties free nodes to fixed ones (of stiffness k_fixed) is a spring in it.
template <class Scalar>
struct SpringSystem {
  GraphMatrix<Scalar> matrix;
  std::vector<Scalar> right;
};
template <class Scalar>
SpringSystem<Scalar> spring_system(const std::vector<GraphEdge<Scalar>>& graph, const std::vector<double>& stiffness,
                                   const std::vector<Scalar>& target) {
  const auto count = static_cast<Index>(stiffness.size());
  std::vector<GraphEdge<Scalar>> free;
  free.reserve(graph.size());
  std::vector<double> diagonal(count);
  SpringSystem<Scalar> result{{}, std::vector<Scalar>(count)};
  for (Index i = 0; i < count; ++i) {
    diagonal[i] = stiffness[i] == k_fixed ? 1 : stiffness[i];
    result.right[i] = diagonal[i] * target[i];
  }
  for (const auto& edge : graph) {
    const bool fixed_a = stiffness[edge.a] == k_fixed, fixed_b = stiffness[edge.b] == k_fixed;
    if (!fixed_a && !fixed_b) {
      free.push_back(edge);
    } else if (!fixed_a) {
      diagonal[edge.a] += std::abs(edge.weight);
      result.right[edge.a] += times(edge.weight, target[edge.b]);
    } else if (!fixed_b) {
      diagonal[edge.b] += std::abs(edge.weight);
      result.right[edge.b] += times(conjugate(edge.weight), target[edge.a]);
    }
  }
  result.matrix = graph_laplacian(count, free);
  for (Index i = 0; i < count; ++i) result.matrix.diagonal[i] += diagonal[i];
  return result;
}

}  // namespace saddleback
