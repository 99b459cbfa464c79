#pragma once
// The shape operator: by how much the normal turns in each direction.

#include <complex>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh/mesh.h"

namespace saddleback {

using Mat3 = Eigen::Matrix3d;

struct ShapeOperator {
  std::vector<Vec3> normals;    ///< per vertex, unit
  std::vector<Mat3> operators;  ///< per vertex, symmetric, in space; zero along the normal
};
/// \throw Cancelled.
ShapeOperator shape_operator(const Mesh& mesh, const JobStage& stage = {});

/// Holds the bending of a face, the mean of its corners' operators in its plane.
struct FaceBending {
  /// Largest less smallest curvature (>= 0) times e^{2 i angle}, the angle in the FaceChart of the largest's direction.
  std::complex<double> difference;
  double sum;  ///< of both curvatures
};
std::vector<FaceBending> bending_of_faces(const Mesh& mesh, const ShapeOperator& shape);

}  // namespace saddleback
