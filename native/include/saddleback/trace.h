#pragma once
// Straightest geodesics: the exponential map.

#include "saddleback/surface_points.h"

namespace saddleback {

/// A curve on the surface: consecutive points share a face.
struct GeodesicPath {
  std::vector<Vec3> points;
  SurfacePoints surface;
  double length = 0;
};

struct TraceResult {
  GeodesicPath path;
  /// Direction of arrival in the chart of the last point's face (radians).
  double end_angle = 0;
  /// True when a boundary stopped the curve before its length was used up.
  bool hit_boundary = false;
};

/// Walks straight on from `start` for `length`. The angle is measured in the FaceChart of start.face or, when the point
/// is exactly a vertex, from first_halfedge(vertex) counter-clockwise on the surface (0 to total_angle). Through a
/// vertex it goes on with half the total angle on either side (Polthier and Schmies 1998); at the boundary it stops.
/// \throw InputError for a point off the mesh, a negative or non-finite length, a non-finite angle. O(faces crossed).
TraceResult trace(const Mesh& mesh, const SurfacePoint& start, double angle, double length);

/// As above, the direction given as a vector in space, projected onto the surface at the start.
TraceResult trace(const Mesh& mesh, const SurfacePoint& start, const Vec3& direction, double length);

}  // namespace saddleback
