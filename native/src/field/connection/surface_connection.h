#pragma once
// The transport of directions from face to face, and the weights of neighboring faces.

#include "saddleback/job.h"
#include "saddleback/mesh/mesh.h"
#include "saddleback/support/large_array.h"

namespace saddleback {

/// Angle of half-edge h in the FaceChart of its face, from the corner angles: 0, pi - angle 1, pi + angle 0.
double chart_angle(const Mesh& mesh, Index h);

struct SurfaceConnection {
  /// Holds for each half-edge, 0 on the boundary: what is added to the angle of a direction in the chart of its face to
  /// have the same direction in the chart of its twin's face (Levi-Civita). Opposite for the twin.
  UnsetArray<double> transport;
  /// Holds for each half-edge: length of the dual edge over that of the edge (half the sum of the cotangents), kept
  /// within a factor k_weight_range of 1. Equal for both twins. Indices of fields do not depend on it, only how they
  /// turn.
  UnsetArray<double> weight;
};

/// Slivers and obtuse pairs would make single edges take all turning, or none; well-shaped meshes never come near.
inline constexpr double k_weight_range = 50;

/// O(F). \throw Cancelled.
SurfaceConnection surface_connection(const Mesh& mesh, const JobStage& stage = {});

}  // namespace saddleback
