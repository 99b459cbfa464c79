#pragma once
// How much of a window propagation is done, told from how far it has come.

#include <vector>

#include "saddleback/job.h"

#include "geodesics/exact_surface.h"

namespace saddleback {

/// Of the time of a propagation that is watched, what passes before it runs: its surface is laid out.
double share_of_surface(const Mesh& mesh, std::size_t source_count, double limit);

/// The share of the work within a distance is guessed from the lengths of paths along edges, which take a tenth of the
/// time; without a watched job nothing is computed.
class ExactProgress {
 public:
  /// Guesses, a part of the stage. \throw Cancelled.
  ExactProgress(const ExactSurface& surface, const SurfacePoints& sources, double limit, const JobStage& stage);
  /// All vertices up to that distance are done. \throw Cancelled.
  void reached(double distance);

 private:
  JobStage stage_;  ///< after the guess
  double per_edge_ = 1;
  std::vector<double> work_;  ///< up to and with each ring about the sources, an edge wide
};

}  // namespace saddleback
