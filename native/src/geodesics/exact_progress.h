#pragma once
// How the time of a propagation of exact distances is spread.

#include <cstdint>

#include "saddleback/job.h"

#include "geodesics/window_forecast.h"

namespace saddleback {

/// What is to be propagated.
struct ExactWork {
  const Mesh& mesh;
  const SurfacePoints& sources;
  double limit;
  bool sorts_windows = false;  ///< afterwards
};

/// How much of a propagation is done: a surface is laid out, windows are foretold, run and maybe sorted. Without a
/// watched job nothing is foretold.
class ExactProgress {
 public:
  /// Mesh and sources outlive this object.
  ExactProgress(const ExactWork& work, const JobStage& stage);

  JobStage laying() const { return stage_.part(0, laid_); }
  /// Of windows in rings of that width about the sources. \throw Cancelled. O(V).
  void foretell(const ExactSurface& surface, double ring_width);
  /// Windows up to that distance are done, so many in all. \throw Cancelled.
  void update(double distance, std::int64_t window_count);
  /// All windows are done. \throw Cancelled.
  void end();
  JobStage sorting() const { return stage_.part(run_, 1); }

 private:
  double cost_of_windows(double count) const;

  const ExactWork work_;
  const JobStage stage_;
  JobStage running_;
  double before_windows_ = 0;                 ///< cost of the surface and the forecast
  double laid_ = 0, foretold_ = 0, run_ = 1;  ///< shares of the whole, so far
  WindowForecast forecast_;
  double per_ring_ = 0;
  std::size_t ring_ = 0, before_ring_ = 0;  ///< windows done when this ring began
};

}  // namespace saddleback
