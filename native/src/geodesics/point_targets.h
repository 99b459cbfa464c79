#pragma once
// From distances at vertices to distances at any point.

#include <span>
#include <vector>

#include "geodesics/point_fans.h"

namespace saddleback {

/// Length of the straight geodesic between two points that are no vertices, infinity unless they see each other within
/// their fans: farther apart, ways over vertices are as good. Equal to the bit from both ends.
double direct_length(const SaddleVertexGraph& graph, const SurfacePoint& a, const PointFan& a_fan,
                     const SurfacePoint& b, const PointFan& b_fan);

/// For each of many targets the sources near enough to be seen.
class NearbySources {
 public:
  explicit NearbySources(std::span<const PointFan> sources);
  /// Sources, each once, whose fans share a vertex with the target's.
  void find(const PointFan& target, std::vector<Index>& sources) const;

 private:
  struct Entry {
    Index vertex, source;
  };
  std::vector<Entry> entries_;  ///< by vertex
};

}  // namespace saddleback
