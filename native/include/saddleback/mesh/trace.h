#pragma once
// Straightest geodesics: the exponential map.

#include <cstdint>
#include <optional>

#include "saddleback/job.h"
#include "saddleback/mesh/surface_points.h"

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

/// Holds where a curve ends, for callers that need no polyline.
struct TraceEnd {
  SurfacePoint point;
  double angle = 0;   ///< direction of arrival in the chart of the point's face (radians)
  double length = 0;  ///< traveled; less than asked for when a boundary stopped the curve
  bool hit_boundary = false;
};

/// Walks straight on from `start` for `length`. The angle is measured in the FaceChart of start.face or, when the point
/// is exactly a vertex, from first_halfedge(vertex) counter-clockwise on the surface (0 to total_angle). Through a
/// vertex it goes on with half the total angle on either side [polthier1998]. At the boundary it stops, unless it comes
/// to a vertex with half a turn or more on one side: there it goes straight on, along a straight border or past a
/// corner that it touches. The polyline has one point for each edge or vertex crossed. An angle that leaves the surface
/// at once (boundary) gives the start with hit_boundary; length 0 gives the start. \throw InputError for a point off
/// the mesh, a negative or non-finite length, a non-finite angle, a curve over more than a million faces.
/// \throw Cancelled. O(faces crossed).
TraceResult trace(const Mesh& mesh, const SurfacePoint& start, double angle, double length, Job* job = nullptr);

/// Works as above, with the direction given as a vector in space, projected onto the surface at the start: onto the
/// face's plane or, at a vertex, to the nearest direction among those of the faces around it. \throw InputError as well
/// for a vector that is not finite or has no part along the surface.
TraceResult trace(const Mesh& mesh, const SurfacePoint& start, const Vec3& direction, double length,
                  Job* job = nullptr);

/// The end of the same curve, to the bit, without its polyline: no allocation.
TraceEnd trace_end(const Mesh& mesh, const SurfacePoint& start, double angle, double length);
TraceEnd trace_end(const Mesh& mesh, const SurfacePoint& start, const Vec3& direction, double length);
/// The same, but nothing where the curve crosses more than so many faces.
std::optional<TraceEnd> trace_end_within(const Mesh& mesh, const SurfacePoint& start, double angle, double length,
                                         std::int64_t most_faces);

/// The angle by which `trace` would set out in that direction.
double start_angle(const Mesh& mesh, const SurfacePoint& start, const Vec3& direction);

/// Returns, for a point that is exactly a vertex: the angle about the vertex (as `trace` takes it) of a direction given
/// in the chart of point.face; for any other point the angle itself. A direction that points out of the face is
/// measured as if the face's plane went on, which is what a reversed or transported direction of arrival needs only
/// when it points in.
double angle_about(const Mesh& mesh, const SurfacePoint& point, double chart_angle);

}  // namespace saddleback
