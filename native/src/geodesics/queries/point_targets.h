#pragma once
// Distances at any point from distances at vertices.

#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "geodesics/queries/source_arcs.h"

namespace saddleback {

/// Length of the straight geodesic between two points that are no vertices, infinity unless they see each other within
/// their fans and it is shorter than any way over one vertex of both. Equal to the bit from both ends. What is `upper`
/// or longer need not be found.
double direct_length(const SaddleVertexGraph& graph, const SurfacePoint& a, const PointFan& a_fan,
                     const SurfacePoint& b, const PointFan& b_fan,
                     double upper = std::numeric_limits<double>::infinity());

/// Finds for each of many targets the sources near enough to be seen.
class NearbySources {
 public:
  /// `fans` begin with those of `points`.
  NearbySources(const SaddleVertexGraph& graph, const SurfacePoints& points, std::span<const PointFan> fans);
  /// The least direct_length between the target and any of the points if it is less than `upper`, else `upper`. On
  /// request also which point it is. \throw Cancelled.
  double least_length(const SurfacePoint& target, const PointFan& fan, double upper, const JobStage& stage,
                      Index* point = nullptr) const;

 private:
  struct Entry {
    double along;
    Index source;
    auto operator<=>(const Entry&) const = default;
  };
  const SaddleVertexGraph& graph_;
  const SurfacePoints& points_;
  std::span<const PointFan> fans_;
  std::vector<Vec3> positions_;
  std::vector<Entry> entries_;  ///< those that are no vertices, along the axis in which they are spread farthest
  Eigen::Index axis_ = 0;
  double reach_ = 0;  ///< of the farthest fan
};

/// Distances of targets from the nearest of points, whose fans are given, where those of the vertices are known: over
/// the vertices that a target sees, or straight. `known`: what else is known of the targets. \throw Cancelled.
std::vector<double> distances_at(const SaddleVertexGraph& graph, const SurfacePoints& points,
                                 std::span<const PointFan> fans, const std::function<double(Index)>& at_vertex,
                                 const SurfacePoints& targets, std::vector<double> known, const JobStage& stage);

}  // namespace saddleback
