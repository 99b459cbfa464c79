#include "field/smoothing/face_springs.h"

#include <cmath>

#include "field/connection/filled_surface.h"
#include "field/linear/row_blocks.h"
#include "field/linear/spring_system.h"

namespace saddleback {
namespace {

using Complex = std::complex<double>;

Index component(const Mesh& mesh, Index face) { return mesh.component_of(mesh.triangles()[face][0]); }

template <class Scalar>
std::vector<bool> held_components(const Mesh& mesh, const FaceSprings<Scalar>& springs) {
  std::vector<bool> result(mesh.component_count(), false);
  for (Index f = 0; f < mesh.face_count(); ++f)
    if (springs.stiffness[f] > 0) result[component(mesh, f)] = true;
  return result;
}

/// Holds what the faces of each vertex ask of it; fixed where one of them is.
struct VertexSprings {
  std::vector<double> stiffness, target;
};
VertexSprings springs_of_vertices(const Mesh& mesh, const FaceSprings<double>& springs) {
  VertexSprings result{std::vector<double>(mesh.vertex_count(), 0.0), std::vector<double>(mesh.vertex_count(), 0.0)};
  std::vector<int> fixed(mesh.vertex_count(), 0);
  for (Index f = 0; f < mesh.face_count(); ++f) {
    if (springs.stiffness[f] != k_fixed) continue;
    for (const Index v : mesh.triangles()[f]) result.target[v] += (springs.target[f] - result.target[v]) / ++fixed[v];
  }
  for (Index f = 0; f < mesh.face_count(); ++f) {
    if (springs.stiffness[f] == 0 || springs.stiffness[f] == k_fixed) continue;
    for (const Index v : mesh.triangles()[f]) {
      if (fixed[v] > 0) continue;
      result.stiffness[v] += springs.stiffness[f] / 3;
      result.target[v] += (springs.target[f] - result.target[v]) * (springs.stiffness[f] / 3) / result.stiffness[v];
    }
  }
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (fixed[v] > 0) result.stiffness[v] = k_fixed;
  return result;
}

/// Smooths out what the mean of vertices leaves from face to face: damped Jacobi rounds, which know no order of faces.
void relax_faces(const Mesh& mesh, const SurfaceConnection& connection, const FaceSprings<double>& springs,
                 std::vector<double>& values, const JobStage& stage) {
  constexpr int k_rounds = 4;
  constexpr double k_damping = 2.0 / 3;
  std::vector<double> next = values;
  for (int round = 0; round < k_rounds; ++round) {
    stage.check();
    for_rows(0, mesh.face_count(), 0, [&](Index f) {
      if (springs.stiffness[f] == k_fixed) return;
      double sum = springs.stiffness[f] * springs.target[f], weight = springs.stiffness[f];
      for (Index h = 3 * f; h < 3 * f + 3; ++h) {
        if (mesh.twin(h) == k_none) continue;
        sum += values[Mesh::face_of(mesh.twin(h))] / connection.weight[h];
        weight += 1 / connection.weight[h];
      }
      if (weight > 0) next[f] = values[f] + k_damping * (sum / weight - values[f]);
    });
    values.swap(next);
  }
}

}  // namespace

std::vector<GraphEdge<double>> vertex_graph(const Mesh& mesh, const SurfaceConnection& connection) {
  std::vector<GraphEdge<double>> result;
  result.reserve(mesh.edge_count());
  for (const Index h : mesh.edge_halfedges()) {
    const double share = mesh.twin(h) == k_none ? 0.5 : 1;
    result.push_back({mesh.from(h), mesh.to(h), share * connection.weight[h]});
  }
  return result;
}

GraphMatrix<Complex> power_matrix(const Mesh& mesh, const PowerGraph& graph, const std::vector<double>& stiffness) {
  const Index count = mesh.face_count();
  GraphMatrix<Complex> result;
  result.begins.resize(count + 1);
  result.diagonal.resize(count);
  const auto joins_free = [&](Index f, Index h) {
    return mesh.twin(h) != k_none && stiffness[f] != k_fixed && stiffness[Mesh::face_of(mesh.twin(h))] != k_fixed;
  };
  for_rows(0, count, 0, [&](Index f) {
    Index joined = 0;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) joined += joins_free(f, h) ? 1 : 0;
    result.begins[f + 1] = joined;
  });
  for (Index f = 0; f < count; ++f) result.begins[f + 1] += result.begins[f];
  result.columns.resize(result.begins.back());
  result.values.resize(result.begins.back());
  for_rows(0, count, 0, [&](Index f) {
    const bool is_fixed = stiffness[f] == k_fixed;
    Index at = result.begins[f];
    double diagonal = is_fixed ? 1 : stiffness[f];
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      if (!is_fixed && mesh.twin(h) != k_none) diagonal += 1 / graph.connection.weight[h];
      if (!joins_free(f, h)) continue;
      result.columns[at] = Mesh::face_of(mesh.twin(h));
      result.values[at++] = -graph.tie(h);
    }
    result.diagonal[f] = diagonal;
  });
  return result;
}

std::vector<Complex> relax_powers(const Mesh& mesh, const PowerGraph& graph, const FaceSprings<Complex>& springs,
                                  const MultigridSolver<Complex>::Accuracy& accuracy, const JobStage& stage) {
  std::vector<double> stiffness = springs.stiffness;
  std::vector<bool> is_held = held_components(mesh, springs);
  for (Index f = 0; f < mesh.face_count(); ++f) {
    if (is_held[component(mesh, f)]) continue;
    is_held[component(mesh, f)] = true;
    stiffness[f] = 1;
  }
  const MultigridSolver<Complex> solver(power_matrix(mesh, graph, stiffness), stage.part(0, 0.2));
  std::vector<Complex> right(mesh.face_count());
  for_rows(0, mesh.face_count(), 0, [&](Index f) {
    const bool is_fixed = stiffness[f] == k_fixed;
    right[f] = (is_fixed ? 1 : stiffness[f]) * springs.target[f];
    for (Index h = 3 * f; h < 3 * f + 3 && !is_fixed; ++h)
      if (const Index twin = mesh.twin(h); twin != k_none && stiffness[Mesh::face_of(twin)] == k_fixed)
        right[f] += times(graph.tie(h), springs.target[Mesh::face_of(twin)]);
  });
  std::vector<Complex> result = solver.solve(right, {}, accuracy, stage.part(0.2, 1));
  for_rows(0, mesh.face_count(), 0, [&](Index f) {
    if (springs.stiffness[f] == k_fixed) result[f] = springs.target[f];
  });
  return result;
}

std::vector<double> relax_angles(const Mesh& mesh, const SurfaceConnection& connection,
                                 const FaceSprings<double>& springs, std::vector<double>& vertices,
                                 const MultigridSolver<double>::Accuracy& accuracy, const JobStage& stage) {
  VertexSprings own = springs_of_vertices(mesh, springs);
  std::vector<bool> is_held = held_components(mesh, springs);
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (is_held[mesh.component_of(v)]) continue;
    is_held[mesh.component_of(v)] = true;
    own.stiffness[v] = 1;
  }
  SpringSystem<double> system = spring_system(vertex_graph(mesh, connection), own.stiffness, own.target);
  const MultigridSolver<double> solver(std::move(system.matrix), stage.part(0, 0.2));
  vertices = solver.solve(system.right, std::move(vertices), accuracy, stage.part(0.2, 0.9));

  std::vector<double> result(mesh.face_count());
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const Triangle& t = mesh.triangles()[f];
    const bool is_fixed = springs.stiffness[f] == k_fixed;
    result[f] = is_fixed ? springs.target[f] : (vertices[t[0]] + vertices[t[1]] + vertices[t[2]]) / 3;
  }
  relax_faces(mesh, connection, springs, result, stage.part(0.9, 1));
  return result;
}

}  // namespace saddleback
