#pragma once
// How much of a propagation from sources outwards is done, told from how far it has come.

#include <limits>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/surface_points.h"

#include "support/work_clock.h"

namespace saddleback {

/// The work within a distance is guessed from the lengths of paths along edges, which take little of the time, and what
/// is still to come from the time so far; without a watched job nothing is computed.
class DistanceProgress {
 public:
  struct Extent {
    double limit = std::numeric_limits<double>::infinity();  ///< where the propagation ends
    double until_bent;  ///< edges up to which a vertex has the more windows the farther it is
  };
  /// \throw Cancelled.
  DistanceProgress(const Mesh& mesh, const SurfacePoints& sources, const Extent& extent, const JobStage& stage);
  /// All vertices up to that distance are done. \throw Cancelled.
  void reached(double distance);

 private:
  JobStage stage_;
  double per_edge_;
  WorkClock clock_;
  double guessed_ = 0;        ///< seconds
  std::vector<double> work_;  ///< up to and with each ring about the sources, an edge wide
};

}  // namespace saddleback
