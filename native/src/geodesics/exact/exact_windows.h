#pragma once
// The windows of a finished propagation by half-edge: what is asked about points that are no vertices.

#include <algorithm>
#include <span>
#include <vector>

#include "saddleback/support/large_array.h"

#include "geodesics/exact/exact_propagation.h"

namespace saddleback {

/// A window without what its place in the table and its root tell.
struct KeptWindow {
  double sx, sy, b0, b1;
};

/// The way from the root of a window, straight through that or bent at its end, to a point in the frame of its
/// half-edge.
struct WayThrough {
  WayThrough(const KeptWindow& w, double before, const Vec2& point) : distance(before), last_bend(w.sx, w.sy) {
    const Vec2 line = point - last_bend;
    const double straight = line.y() > 0 ? w.sx - line.x() * (w.sy / line.y()) : std::clamp(point.x(), w.b0, w.b1);
    crossing = std::clamp(straight, w.b0, w.b1);
    if (crossing == straight) {
      distance += line.norm();
    } else {
      const Vec2 end(crossing, 0);
      distance += (end - last_bend).norm() + (point - end).norm();
      last_bend = end;
    }
  }
  double distance;  ///< what is before the root included
  double crossing;  ///< of the half-edge, from its start
  Vec2 last_bend;   ///< the root's image or the window's end
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
  static constexpr std::size_t k_bytes_each = sizeof(KeptWindow) + sizeof(Index);
  /// \throw Cancelled.
  KeptWindows(const ExactSurface& surface, const ExactPropagation& propagation, const JobStage& stage);

  /// Shortens `best` if a window of the half-edge leads to the point (in the half-edge's frame) on a shorter way.
  void improve(Index halfedge, const Vec2& point, SightLine& best) const;
  /// Visits every window of the half-edge and its root.
  template <class Visit>
  void visit(Index halfedge, Visit&& visit) const {
    for (std::int64_t i = begins_[halfedge]; i < begins_[halfedge + 1]; ++i) visit(windows_[i], roots_[i]);
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
