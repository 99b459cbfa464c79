#pragma once
// Sites that move along geodesics, and tangent vectors that they carry along.

#include <span>
#include <vector>

#include "saddleback/mesh/surface_points.h"

namespace saddleback {

/// A vector in the tangent plane of each site (axes as CellLogMaps).
using TangentField = std::vector<Vec2>;

/// The places where sites came to rest, and the turns of directions along the way.
struct Moved {
  SurfacePoints sites;
  TangentField steps;  ///< as made (a boundary may have stopped them), in the new tangent planes
  TangentField turns;  ///< cosine and sine of the angle by which a vector carried along turns against the axes
};

/// Moves every site along its step by the exponential map. A step of length 0, or one that cannot be traced (round a
/// spike thinner than rounding a curve turns without end), leaves its site. Parallel transport along straightest
/// geodesics keeps the angle to the geodesic. O(faces crossed). `order`: of all sites, in which they lie close in
/// memory one after the other; any will do, and none, for the same result.
Moved move_sites(const Mesh& mesh, const SurfacePoints& sites, const TangentField& steps, int threads,
                 std::span<const Index> order = {});

/// A vector in space, as the face's plane has it, in the face's chart. Zero where the face has no plane.
Vec2 in_chart(const Mesh& mesh, Index face, const Vec3& vector);

/// A direction given in the chart of the point's face as an angle of the point's tangent plane.
double tangent_heading(const Mesh& mesh, const SurfacePoint& point, double chart_angle);

/// The other way round: a direction of the tangent plane as an angle about the point. At a vertex it counts from the
/// first half-edge, on the border so that what is no direction of the surface lies as far before as behind its fan.
double surface_angle(const Mesh& mesh, const SurfacePoint& point, double heading);

/// The field carried along.
void transport(const Moved& moved, TangentField& field);

double dot(const TangentField& a, const TangentField& b);

}  // namespace saddleback
