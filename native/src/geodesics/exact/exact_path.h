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
  /// Visits (distance, root, image) of every way to a point of a face: from sources in it, from its corners, through
  /// its edges. `image` is that of the root, in the plane of `place_of`; a way that bends at the end of what is seen
  /// through an edge is longer than the line from there. A corner is taken as a point of the face like any other.
  template <class Visit>
  void visit_ways(const SurfacePoint& point, Visit&& visit) const;
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

template <class Visit>
void ExactTracer::visit_ways(const SurfacePoint& point, Visit&& visit) const {
  if (!surface_.holds(point.face)) return;
  const Index first = 3 * surface_.face_of(point.face);
  const Vec2 at = surface_.in_frame(first, point.barycentric);
  for (const SourceInFace& source : surface_.sources_in(first / 3)) {
    const Vec2 image = surface_.in_frame(first, source.barycentric);
    visit((at - image).norm(), surface_.vertex_count() + source.source, image);
  }
  for (Index i = 0; i < 3; ++i) {
    const Index h = first + i, corner = surface_.frame(h).from;
    const Vec2 start = surface_.in_frame(first, Vec3::Unit(i)), end = surface_.in_frame(first, Vec3::Unit((i + 1) % 3)),
               along = (end - start).normalized(), up(-along.y(), along.x());
    const Vec2 place = surface_.in_frame(h, point.barycentric);
    visit(propagation_.distance(corner) + place.norm(), corner, start);
    windows_.visit(h, place, [&](const SightLine& way) {
      visit(way.distance, way.root, Vec2(start + way.image.x() * along + way.image.y() * up));
    });
  }
}

}  // namespace saddleback
