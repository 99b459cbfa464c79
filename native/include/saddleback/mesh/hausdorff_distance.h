#pragma once
// The distance of two surfaces from each other.

#include "saddleback/job.h"
#include "saddleback/mesh/surface_points.h"

namespace saddleback {

/// The point of one surface that is farthest from another.
struct FarthestPoint {
  SurfacePoint point;   ///< of the first surface
  double distance = 0;  ///< straight through space, from the other
};

struct HausdorffOptions {
  double tolerance = 1e-4;  ///< of the distance, as a share of the diagonal of both meshes' box
  double limit = 0;         ///< a length: only whether something is farther is told; 0: the distance
  int threads = 0;          ///< 0: all cores; the result does not depend on it
};

/// The greatest distance from any point of one mesh, not its vertices alone, to the other; too small by the tolerance
/// at most. Both directions, and the greater of the two, make the Hausdorff distance. With a limit a distance above it
/// may be any of those, and one below anything up to it, or the tolerance more than it says. \throw InputError for a
/// tolerance that is not above 0, a limit that is negative; Cancelled. About O((V + F) log F): triangles are divided
/// where they might hold a farther point [tang2009].
FarthestPoint farthest_point(const Mesh& from, const Mesh& to, const HausdorffOptions& options = {},
                             const JobStage& stage = {});

}  // namespace saddleback
