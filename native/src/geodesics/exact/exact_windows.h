#pragma once
// The windows of a finished propagation by half-edge: what is asked about points that are no vertices.

#include <span>
#include <vector>

#include "saddleback/support/large_array.h"

#include "geodesics/exact/exact_propagation.h"

namespace saddleback {

/// A window without what its place in the table and its root tell.
struct KeptWindow {
  double sx, sy, b0, b1;
};

/// A straight line from a root through a half-edge to a point of the face beyond it.
struct SightLine {
  double distance = std::numeric_limits<double>::infinity();  ///< of the point, the root's included
  double crossing = 0;                                        ///< of the half-edge, from its start
  Index halfedge = k_none;
  Index root = k_none;
  Vec2 image = Vec2::Zero();  ///< of the root, in the frame of the half-edge
};

/// Windows that some corner of their edge does not make needless, sorted by half-edge. 36 bytes each.
class KeptWindows {
 public:
  /// \throw Cancelled.
  KeptWindows(const ExactSurface& surface, const ExactPropagation& propagation, const JobStage& stage);

  /// Shortens `best` if a window of the half-edge leads to the point (in the half-edge's frame) on a shorter way.
  void improve(Index halfedge, const Vec2& point, SightLine& best) const;
  /// Visits every window of the half-edge as the way through it to the point (in the half-edge's frame).
  template <class Visit>
  void visit(Index halfedge, const Vec2& point, Visit&& visit) const {
    for (std::int64_t i = begins_[halfedge]; i < begins_[halfedge + 1]; ++i) visit(way_through(i, halfedge, point));
  }
  std::size_t nbytes() const;

 private:
  SightLine way_through(std::int64_t i, Index halfedge, const Vec2& point) const;

  const ExactSurface& surface_;
  const ExactPropagation& propagation_;
  std::vector<std::int64_t> begins_;
  LargeArray<KeptWindow> windows_;
  LargeArray<Index> roots_;
};

}  // namespace saddleback
