#pragma once
// The distance between two points by A*.

#include <limits>
#include <vector>

#include "saddleback/geodesics/saddle_vertex_graph.h"

#include "geodesics/queries/landmarks.h"
#include "geodesics/queries/source_arcs.h"
#include "support/bucket_queue.h"

namespace saddleback {

/// A* from the vertices of one fan to those of another, bounded from below by landmarks and the straight line through
/// space. Exact: a node is expanded only while it may lie on a shorter path than the best known. Holds its memory,
/// which every run leaves clean, so that a short path costs as little as it is short; one a thread and graph.
class PointSearch {
 public:
  /// The distance is `upper` when no path is shorter. `target` is the place that `to` is the fan of. \throw Cancelled.
  PointDistance run(const SaddleVertexGraph& graph, const Landmarks& landmarks, const PointFan& from,
                    const PointFan& to, const Vec3& target, double upper, const JobStage& stage);

 private:
  /// Holds what the search keeps of a node that it has met.
  struct Met {
    double bound = -1;                                           ///< of the distance that is left; negative: not met
    double to_target = std::numeric_limits<double>::infinity();  ///< by an arc of the target's fan
  };
  class Run;
  void clean();

  double width_ = 0;  ///< of the queue's buckets; 0: not known yet
  std::vector<double> distances_;
  std::vector<Met> met_;
  std::vector<Index> touched_;
  BucketQueue queue_;
};

}  // namespace saddleback
