#include "face_springs.h"

#include <cmath>

#include "filled_surface.h"

namespace saddleback {

std::vector<GraphEdge<double>> face_graph(const Mesh& mesh, const SurfaceConnection& connection) {
  std::vector<GraphEdge<double>> result;
  result.reserve(mesh.edge_count());
  for (const Index h : inner_edges(mesh))
    result.push_back({Mesh::face_of(h), Mesh::face_of(mesh.twin(h)), 1 / connection.weight[h]});
  return result;
}

std::vector<GraphEdge<std::complex<double>>> face_graph(const Mesh& mesh, const SurfaceConnection& connection,
                                                        int symmetry) {
  std::vector<GraphEdge<std::complex<double>>> result;
  result.reserve(mesh.edge_count());
  for (const Index h : inner_edges(mesh)) {
    const auto carried = std::polar(1 / connection.weight[h], -symmetry * connection.transport[h]);
    result.push_back({Mesh::face_of(h), Mesh::face_of(mesh.twin(h)), carried});
  }
  return result;
}

template <class Scalar>
std::vector<Scalar> relax_springs(const Mesh& mesh, const std::vector<GraphEdge<Scalar>>& graph,
                                  const FaceSprings<Scalar>& springs, std::vector<Scalar> guess,
                                  const typename MultigridSolver<Scalar>::Accuracy& accuracy, const JobStage& stage) {
  // Fixed faces are taken out of the graph: what ties others to them becomes a spring.
  const auto is_fixed = [&](Index f) { return springs.stiffness[f] == k_fixed; };
  std::vector<GraphEdge<Scalar>> free;
  free.reserve(graph.size());
  std::vector<double> stiffness(mesh.face_count(), 0.0);
  std::vector<Scalar> right(mesh.face_count(), Scalar(0));
  for (const auto& edge : graph) {
    if (!is_fixed(edge.a) && !is_fixed(edge.b)) {
      free.push_back(edge);
    } else if (!is_fixed(edge.a)) {
      stiffness[edge.a] += std::abs(edge.weight);
      right[edge.a] += times(edge.weight, springs.target[edge.b]);
    } else if (!is_fixed(edge.b)) {
      stiffness[edge.b] += std::abs(edge.weight);
      right[edge.b] += times(conjugate(edge.weight), springs.target[edge.a]);
    }
  }
  std::vector<bool> is_held(mesh.component_count(), false);
  for (Index f = 0; f < mesh.face_count(); ++f)
    if (springs.stiffness[f] > 0) is_held[mesh.component_of(mesh.triangles()[f][0])] = true;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const Index component = mesh.component_of(mesh.triangles()[f][0]);
    if (is_fixed(f)) {
      stiffness[f] = 1;
      right[f] = springs.target[f];
    } else if (springs.stiffness[f] > 0) {
      stiffness[f] += springs.stiffness[f];
      right[f] += springs.stiffness[f] * springs.target[f];
    } else if (!is_held[component]) {
      is_held[component] = true;
      stiffness[f] += 1;
    }
  }
  GraphMatrix<Scalar> matrix = graph_laplacian(mesh.face_count(), free);
  for (Index f = 0; f < mesh.face_count(); ++f) matrix.diagonal[f] += stiffness[f];
  const MultigridSolver<Scalar> solver(std::move(matrix), stage.part(0, 0.2));
  std::vector<Scalar> result = solver.solve(right, std::move(guess), accuracy, stage.part(0.2, 1));
  for (Index f = 0; f < mesh.face_count(); ++f)
    if (is_fixed(f)) result[f] = springs.target[f];
  return result;
}

template std::vector<double> relax_springs(const Mesh&, const std::vector<GraphEdge<double>>&,
                                           const FaceSprings<double>&, std::vector<double>,
                                           const MultigridSolver<double>::Accuracy&, const JobStage&);
template std::vector<std::complex<double>> relax_springs(
    const Mesh&, const std::vector<GraphEdge<std::complex<double>>>&, const FaceSprings<std::complex<double>>&,
    std::vector<std::complex<double>>, const MultigridSolver<std::complex<double>>::Accuracy&, const JobStage&);

}  // namespace saddleback
