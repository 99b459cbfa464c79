#pragma once
// Linear problems over faces: values that vary as little as possible from face to face and are drawn to given ones.

#include <complex>
#include <limits>
#include <vector>

#include "multigrid.h"
#include "surface_connection.h"

namespace saddleback {

inline constexpr double k_fixed = std::numeric_limits<double>::infinity();

/// What draws the value of each face: 0 nothing, k_fixed exactly.
template <class Scalar>
struct FaceSprings {
  explicit FaceSprings(const Mesh& mesh) : stiffness(mesh.face_count(), 0.0), target(mesh.face_count(), Scalar(0)) {}
  std::vector<double> stiffness;
  std::vector<Scalar> target;
};

/// The edges of the dual graph: between neighbours the inverse of the weight, as the energy of turning has it. For
/// complex numbers these are powers of directions, carried from face to face `symmetry` times.
std::vector<GraphEdge<double>> face_graph(const Mesh& mesh, const SurfaceConnection& connection);
std::vector<GraphEdge<std::complex<double>>> face_graph(const Mesh& mesh, const SurfaceConnection& connection,
                                                        int symmetry);

/// The equilibrium of springs. Components without any are held at 0 in their smallest face. `guess` may be empty.
template <class Scalar>
std::vector<Scalar> relax_springs(const Mesh& mesh, const std::vector<GraphEdge<Scalar>>& graph,
                                  const FaceSprings<Scalar>& springs, std::vector<Scalar> guess,
                                  const typename MultigridSolver<Scalar>::Accuracy& accuracy, const JobStage& stage);

extern template std::vector<double> relax_springs(const Mesh&, const std::vector<GraphEdge<double>>&,
                                                  const FaceSprings<double>&, std::vector<double>,
                                                  const MultigridSolver<double>::Accuracy&, const JobStage&);
extern template std::vector<std::complex<double>> relax_springs(
    const Mesh&, const std::vector<GraphEdge<std::complex<double>>>&, const FaceSprings<std::complex<double>>&,
    std::vector<std::complex<double>>, const MultigridSolver<std::complex<double>>::Accuracy&, const JobStage&);

}  // namespace saddleback
