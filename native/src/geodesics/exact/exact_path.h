#pragma once
// Shortest paths traced back from a finished propagation.

#include "saddleback/mesh/trace.h"

#include "geodesics/exact/exact_windows.h"

namespace saddleback {

/// The shortest way to a surface point: its last stretch is straight from a root.
struct Approach {
  double distance = std::numeric_limits<double>::infinity();
  Index root = k_none;  ///< as Window::root
  SightLine line;       ///< through which half-edge, in whose frame; k_none: within the point's own face
};

/// Follows shortest paths. Any number of threads may use one tracer.
class ExactTracer {
 public:
  /// All of them outlive the tracer.
  ExactTracer(const ExactSurface& surface, const SurfacePoints& sources, const ExactPropagation& propagation,
              const KeptWindows& windows);

  /// O(windows on the face's edges).
  Approach approach(const SurfacePoint& point) const;
  /// Returns the place of a point in the plane of its face, which some source must reach.
  Vec2 place_of(const SurfacePoint& point) const {
    return surface_.in_frame(3 * surface_.face_of(point.face), point.barycentric);
  }
  /// Leads from its source to `target`, which some source must reach. O(windows on the edges crossed).
  GeodesicPath path(const SurfacePoint& target) const;

 private:
  Approach approach_vertex(Index vertex) const;
  Index follow(const SightLine& line, const Vec2& from, SurfacePoints& backwards) const;
  bool is_image_of(Index root, Index halfedge, const Vec2& image) const;
  SurfacePoint on_edge(Index halfedge, double place) const;

  const ExactSurface& surface_;
  const SurfacePoints& sources_;
  const ExactPropagation& propagation_;
  const KeptWindows& windows_;
};

}  // namespace saddleback
