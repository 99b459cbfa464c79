#pragma once
// Values of faces that vary as little as possible and are drawn to given ones: linear systems.

#include <algorithm>
#include <complex>
#include <vector>

#include "field/connection/surface_connection.h"
#include "field/linear/multigrid.h"
#include "field/linear/spring_system.h"

namespace saddleback {

/// The dual graph for powers of directions: neighbors are tied by the inverse of the weight, as the energy of turning
/// has it, and carried across `symmetry` times.
struct PowerGraph {
  const SurfaceConnection& connection;
  int symmetry;

  /// Returns what the value beyond a half-edge adds to that of its face.
  std::complex<double> tie(Index h) const {
    return std::polar(1 / connection.weight[h], -symmetry * connection.transport[h]);
  }
};

/// Stiffness of what is drawn softly with weight 1 all through a face, against about that of the usual tie to each
/// neighbor: fields meet it to within a degree or two.
inline constexpr double k_drawn_stiffness = 30, k_usual_tie = 1.7;

/// A positive weight within bounds beyond which fields tell no difference: the solver works in single precision, and
/// squares what draws.
inline double weight_within_bounds(double weight) { return std::clamp(weight, 1e-100, 1e24); }

/// Holds what draws the value of each face: stiffness 0 for nothing, k_fixed for exactly.
template <class Scalar>
struct FaceSprings {
  explicit FaceSprings(const Mesh& mesh) : stiffness(mesh.face_count(), 0.0), target(mesh.face_count(), Scalar(0)) {}
  std::vector<double> stiffness;
  std::vector<Scalar> target;
};

/// The edges between vertices, tied by the weight.
std::vector<GraphEdge<double>> vertex_graph(const Mesh& mesh, const SurfaceConnection& connection);

/// The graph's Laplacian and, in the diagonal, the stiffness; faces of stiffness k_fixed are apart.
GraphMatrix<std::complex<double>> power_matrix(const Mesh& mesh, const PowerGraph& graph,
                                               const std::vector<double>& stiffness);

/// The equilibrium of powers. Components without springs are held at 0 in their smallest face.
std::vector<std::complex<double>> relax_powers(const Mesh& mesh, const PowerGraph& graph,
                                               const FaceSprings<std::complex<double>>& springs,
                                               const MultigridSolver<std::complex<double>>::Accuracy& accuracy,
                                               const JobStage& stage);

/// The equilibrium of angles, to within the size of faces: that of the vertices, each drawn as its faces are, then a
/// few rounds over the faces, which keep what is fixed. A third of the time that the faces' own system takes.
/// `vertices` holds values to begin from, or nothing, and takes the new ones.
std::vector<double> relax_angles(const Mesh& mesh, const SurfaceConnection& connection,
                                 const FaceSprings<double>& springs, std::vector<double>& vertices,
                                 const MultigridSolver<double>::Accuracy& accuracy, const JobStage& stage);

}  // namespace saddleback
