#pragma once
// Sparse matrices of weighted graphs: what fields over a surface are solved with.

#include <complex>
#include <vector>

#include "saddleback/support/large_array.h"
#include "saddleback/types.h"

namespace saddleback {

/// Symmetric (of complex numbers: Hermitian) and positive semidefinite: one row a node, the diagonal apart.
template <class Scalar>
struct GraphMatrix {
  using Real = decltype(std::real(Scalar()));
  UnsetArray<Index> begins{0};  ///< where each row begins in `columns` and `values`; one more entry closes the last
  UnsetArray<Index> columns;
  UnsetArray<Scalar> values;
  UnsetArray<Real> diagonal;

  Index size() const { return static_cast<Index>(diagonal.size()); }
};

// Products without the care for infinities that std::complex takes, which costs a call each.
inline float times(float a, float b) { return a * b; }
inline double times(double a, double b) { return a * b; }
template <class Real>
std::complex<Real> times(const std::complex<Real>& a, const std::complex<Real>& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}
inline float conjugate(float a) { return a; }
inline double conjugate(double a) { return a; }
template <class Real>
std::complex<Real> conjugate(const std::complex<Real>& a) {
  return std::conj(a);
}

/// Row i times x, without the diagonal's part.
template <class Scalar, class Vector>
Scalar row_sum(const GraphMatrix<Scalar>& matrix, Index i, const Vector& x) {
  Scalar sum(0);
  for (Index k = matrix.begins[i]; k < matrix.begins[i + 1]; ++k) sum += times(matrix.values[k], x[matrix.columns[k]]);
  return sum;
}

/// Row i times x.
template <class Scalar, class Vector>
Scalar row_product(const GraphMatrix<Scalar>& matrix, Index i, const Vector& x) {
  return matrix.diagonal[i] * x[i] + row_sum(matrix, i, x);
}

/// An edge of a graph: the matrix holds -weight at (a, b), its conjugate at (b, a), and its size in both diagonals.
template <class Scalar>
struct GraphEdge {
  Index a, b;
  Scalar weight;
};

/// The graph's Laplacian. Several edges between two nodes are allowed, edges from a node to itself count for nothing.
template <class Scalar>
GraphMatrix<Scalar> graph_laplacian(Index node_count, const std::vector<GraphEdge<Scalar>>& edges) {
  GraphMatrix<Scalar> result;
  result.diagonal.assign(node_count, 0);
  result.begins.assign(node_count + 1, 0);
  for (const auto& edge : edges) {
    if (edge.a == edge.b) continue;
    ++result.begins[edge.a + 1], ++result.begins[edge.b + 1];
    result.diagonal[edge.a] += std::abs(edge.weight);
    result.diagonal[edge.b] += std::abs(edge.weight);
  }
  for (Index i = 0; i < node_count; ++i) result.begins[i + 1] += result.begins[i];
  std::vector<Index> next(result.begins.begin(), result.begins.end() - 1);
  result.columns.resize(result.begins.back());
  result.values.resize(result.begins.back());
  for (const auto& edge : edges) {
    if (edge.a == edge.b) continue;
    const Index at_a = next[edge.a]++, at_b = next[edge.b]++;
    result.columns[at_a] = edge.b, result.values[at_a] = -edge.weight;
    result.columns[at_b] = edge.a, result.values[at_b] = -conjugate(edge.weight);
  }
  return result;
}

}  // namespace saddleback
