#pragma once
// How much of a window propagation is done, told from how far it has come.

#include <vector>

#include "saddleback/job.h"

#include "geodesics/exact_surface.h"

namespace saddleback {

/// The share of the work within a distance is guessed from the lengths of paths along edges, which take a twentieth of
/// the time; without a watched job nothing is computed.
class ExactProgress {
 public:
  ExactProgress(const ExactSurface& surface, const SurfacePoints& sources, double limit, const JobStage& stage);
  /// All vertices up to that distance are done. \throw Cancelled.
  void reached(double distance);

 private:
  const JobStage& stage_;
  std::vector<double> distances_;  ///< guessed, ascending
  std::vector<double> work_;       ///< up to and with each
  std::size_t next_ = 0;
};

}  // namespace saddleback
