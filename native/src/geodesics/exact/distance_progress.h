#pragma once
// How much of a propagation from sources outwards is done, told from how far it has come.

#include <limits>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh/surface_points.h"

#include "support/work_clock.h"

namespace saddleback {

/// The windows of each ring about the sources are guessed from ways along edges, which take little of the time, and
/// what is still to come from the time so far; without a watched job nothing is computed. Every vertex of the front
/// splits a window. Windows end where the surface has bent them so much that they meet others, and with the
/// front where it meets itself; but where curvature alone draws it together, as on the far side of a sphere, they live
/// on, more and more side by side.
class DistanceProgress {
 public:
  /// Up to a distance. `clock`: since when the stage has lasted. \throw Cancelled.
  DistanceProgress(const Mesh& mesh, const SurfacePoints& sources, double limit, const WorkClock& clock,
                   const JobStage& stage);
  /// The propagation has come so far, to so many vertices. \throw Cancelled.
  void reached(double distance, Index vertices);

 private:
  /// Work up to a ring or a part of it.
  double work_before(double ring) const;

  JobStage stage_;
  double per_edge_, limit_;
  WorkClock clock_;
  double guessing_ = 0;  ///< seconds
  double began_ = -1;    ///< the propagation, seconds; below 0 before
  // Up to and without each ring, an edge wide as ways along edges tell it.
  std::vector<double> vertices_{0.0}, work_{0.0};
  std::size_t ring_ = 0;  ///< that has been come to
};

}  // namespace saddleback
