#pragma once
// How the time of a propagation of exact distances is spread.

#include <cstdint>

#include "saddleback/job.h"

#include "geodesics/exact/window_forecast.h"
#include "support/memory/prefaulted_pages.h"
#include "support/work_clock.h"

namespace saddleback {

/// What is to be propagated.
struct ExactWork {
  const Mesh& mesh;
  const SurfacePoints& sources;
  double limit;
  bool sorts_windows = false;  ///< afterwards
};

/// How much of a propagation is done: a surface is laid out, windows are foretold, run and maybe sorted. The share is
/// the time so far of that and what is still to come, which is told from how long the parts before it took: one
/// machine's memory, or a second call on warm pages, differs from another's. Without a watched job nothing is foretold,
/// nor where many sources have few vertices each: there these are counted.
class ExactProgress {
 public:
  /// So far.
  struct Done {
    double distance = 0;
    std::int64_t windows = 0;
    Index vertices = 0;                        ///< that are reached
    std::int64_t blocks = 0, blocks_left = 0;  ///< of windows
  };
  /// Mesh and sources outlive this object.
  ExactProgress(const ExactWork& work, const JobStage& stage);

  JobStage laying() const { return stage_.part(0, laid_); }
  /// Of windows in rings of that width about the sources. \throw Cancelled. O(V).
  void foretell(const ExactSurface& surface, double ring_width);
  bool is_watched() const { return stage_.is_watched(); }
  /// So many windows are kept so far, each of which will need so many bytes when they are sorted. These are touched as
  /// windows are kept: on fresh pages that may take as long as the rest of it.
  void kept(std::int64_t windows, std::size_t bytes);
  /// Sorting some of the windows was tried: how many of them are needed, and the seconds that it would take.
  void tried_sorting(std::int64_t windows, std::int64_t needed, double seconds);
  /// \throw Cancelled.
  void update(const Done& done);
  /// All windows are done. \throw Cancelled.
  void end();
  JobStage sorting() const { return stage_.part(run_, 1); }

 private:
  double share_by_vertices(const Done& done) const;
  double share_by_rings(const Done& done);

  const ExactWork work_;
  const JobStage stage_;
  const WorkClock clock_;
  bool is_foretold_ = false;
  double likely_vertices_ = 0;
  double of_surface_ = 0, of_forecast_ = 0, of_running_ = 0;  ///< likely costs
  double sorting_ = 0;                                        ///< in times of running
  std::int64_t tried_ = 0, needed_ = 0;                       ///< windows that sorting was tried with
  double trying_ = 0;                                         ///< seconds
  double began_ = 0, expected_ = 0;                           ///< running, in seconds
  double laid_ = 0, run_ = 1;                                 ///< shares of the whole
  WindowForecast forecast_;
  PrefaultedPages pages_;
  double per_ring_ = 0;
  std::size_t ring_ = 0, before_ring_ = 0;  ///< windows done when this ring began
};

}  // namespace saddleback
