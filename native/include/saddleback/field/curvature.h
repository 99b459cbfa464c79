#pragma once
// The bending of a surface.

#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh/mesh.h"

namespace saddleback {

/// Curvatures at each vertex, in 1 / length, positive where the surface bends away from its normal (a sphere's are 1 /
/// radius).
struct PrincipalCurvatures {
  std::vector<double> smallest, largest;  ///< smallest <= largest
  std::vector<Vec3> direction;            ///< of `largest`, a unit vector in the vertex' tangent plane, up to its sign
};

/// Computes them from the change of vertex normals over each face, averaged about vertices by area [rusinkiewicz2004].
/// O(F). \throw Cancelled.
PrincipalCurvatures principal_curvatures(const Mesh& mesh, Job* job = nullptr);

}  // namespace saddleback
