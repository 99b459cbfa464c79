#pragma once
// Values of faces that vary as little as possible and are drawn to given ones: linear systems.

#include <complex>
#include <vector>

#include "field/connection/surface_connection.h"
#include "field/linear/multigrid.h"
#include "field/linear/spring_system.h"

namespace saddleback {

using PowerGraph = std::vector<GraphEdge<std::complex<double>>>;

/// Stiffness of what is drawn softly with weight 1 all through a face, against about that of the usual tie to each
/// neighbor: fields meet it to within a degree or two.
inline constexpr double k_drawn_stiffness = 30, k_usual_tie = 1.7;

/// Holds what draws the value of each face: stiffness 0 for nothing, k_fixed for exactly.
template <class Scalar>
struct FaceSprings {
  explicit FaceSprings(const Mesh& mesh) : stiffness(mesh.face_count(), 0.0), target(mesh.face_count(), Scalar(0)) {}
  std::vector<double> stiffness;
  std::vector<Scalar> target;
};

/// The edges between vertices, tied by the weight.
std::vector<GraphEdge<double>> vertex_graph(const Mesh& mesh, const SurfaceConnection& connection);

/// The edges of the dual graph for powers of directions: neighbors are tied by the inverse of the weight, as the
/// energy of turning has it, and carried across `symmetry` times.
PowerGraph power_graph(const Mesh& mesh, const SurfaceConnection& connection, int symmetry, const JobStage& stage);

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
