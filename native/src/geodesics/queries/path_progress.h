#pragma once
// How the time of finding many paths is spread.

#include <atomic>
#include <vector>

#include "saddleback/geodesics/geodesic_paths.h"

#include "geodesics/queries/label_propagation.h"
#include "support/work_clock.h"

namespace saddleback {

/// How much of a call is done: a field is laid about the sources, then a path is followed to each target. Costs are
/// numbers of nodes that the field expands in the time; what is still to come is told from how long these took so far.
class PathProgress {
 public:
  struct Work {
    const SurfacePoints& sources;
    const SurfacePoints& targets;
    const PathOptions& options;
  };
  PathProgress(const SaddleVertexGraph& graph, const Work& work, const JobStage& stage);

  /// How many times the cost of fans, as cost_of_fans tells it, those with angles are: paths need them.
  static constexpr double k_with_angles = 1.8;
  /// Of the sources' fans, which cost so much without angles, and of the field from them.
  static double cost_of_field(const SaddleVertexGraph& graph, double of_fans);
  /// Of the fans of sources and the field, and then of what fans of targets need.
  JobStage field() const { return stage_.part(0, with_field_); }
  JobStage fan_mesh() const { return stage_.part(with_field_, prepared_); }
  /// Everything is ready for the paths. By the thread that made this.
  void begin_paths(const LabelField& field);
  /// Of that target's path and fan, among all. After `begin_paths`.
  double share_of(std::size_t target) const { return costs_[target] / all_; }
  /// Of targets whose paths are found; by any thread. \throw Cancelled.
  void found(double share, int thread);

 private:
  double cost_of_path(double edges) const;
  double cost_inside(double edges) const;

  const SaddleVertexGraph& graph_;
  const Work work_;
  const JobStage stage_;
  const double threads_;
  const double of_look_;  ///< cost, of seeing a target inside a face from the sources near it
  const WorkClock clock_;
  double before_;                 ///< cost of what comes before the paths
  double with_field_, prepared_;  ///< shares of the whole
  double of_fan_;                 ///< cost, of a target inside a face
  std::vector<double> costs_;     ///< of the targets
  double all_ = 1;                ///< their sum
  double prepared_at_ = 0;        ///< seconds
  std::atomic<double> done_{0};   ///< share of the paths
};

}  // namespace saddleback
