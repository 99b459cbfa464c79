#pragma once
// Points anywhere on a mesh.

#include <span>
#include <vector>

#include "saddleback/mesh/mesh.h"
#include "saddleback/types.h"

namespace saddleback {

/// A point of the surface: a face and barycentric coordinates (>= 0, sum 1) in the order of the face's corners.
struct SurfacePoint {
  Index face = 0;
  Vec3 barycentric = Vec3(1, 0, 0);
};

using SurfacePoints = std::vector<SurfacePoint>;

/// Bounds what counts as rounding in given barycentric coordinates: they often come as float32 (relative 6e-8), or from
/// sums.
inline constexpr double k_barycentric_tolerance = 1e-6;

/// Position in space.
Vec3 position(const Mesh& mesh, const SurfacePoint& point);

/// The surface point that is exactly the vertex.
SurfacePoint at_vertex(const Mesh& mesh, Index vertex);

/// The vertex that the point is exactly at (a barycentric coordinate equal to 1), else k_none.
Index vertex_at(const Mesh& mesh, const SurfacePoint& point);

/// Points from flat arrays: a face each, three coordinates each; rounding removed as by normalized_barycentric, where
/// it is more than that of the last bits: points that were given out come back as they were. \throw InputError when the
/// lengths differ, or naming the first negative face or coordinates that are not finite, negative or not summing to 1.
/// What only a mesh can tell is left to check_surface_points.
SurfacePoints surface_points(std::span<const Index> faces, std::span<const double> barycentric);

/// \throw InputError naming `argument` and the first offender: face out of range, coordinates not finite, negative or
/// not summing to 1 (beyond rounding, k_barycentric_tolerance).
void check_surface_points(const Mesh& mesh, const SurfacePoints& points, const char* argument);

/// Does the same for one point.
void check_surface_point(const Mesh& mesh, const SurfacePoint& point, const char* argument);

/// Coordinates with the rounding removed: negative ones set to 0, then scaled to sum 1. A point within rounding of a
/// vertex's (1, 0, 0) only becomes exactly that when its other two coordinates are not positive.
Vec3 normalized_barycentric(const Vec3& barycentric);

/// A face's own plane: corner 0 at the origin, corner 1 on the positive x axis, corner 2 above it. Angles of directions
/// at a point in the face are measured in this chart, from the x axis counter-clockwise.
struct FaceChart {
  Vec2 corner[3];
  FaceChart(const Mesh& mesh, Index face);
  Vec2 to_plane(const Vec3& barycentric) const;
  Vec3 to_barycentric(const Vec2& xy) const;
};

/// The direction in a face's chart as a unit vector in space; where lengths were given, as the positions show it, and 0
/// where they do not.
Vec3 direction_in_space(const Mesh& mesh, Index face, double angle);

}  // namespace saddleback
