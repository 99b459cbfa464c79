#pragma once
// Coordinates along a curve that do not fold.

#include <vector>

#include "saddleback/mesh/surface_curve.h"

namespace saddleback {

/// The surface about a curve as a patch with a place in the plane for every vertex.
struct StrokeMap {
  std::vector<Triangle> triangles;  ///< of the patch, oriented as the mesh; the right of the curve first
  std::vector<Index> face_origin;   ///< (m) face of the mesh that each triangle is a part of
  SurfacePoints points;             ///< (n) where the patch's vertices lie on the mesh
  std::vector<Vec3> vertices;       ///< (n) the same in space
  std::vector<Vec2> uv;             ///< (n) along the curve, 0 to its length; distance from it, positive on the left
  double length = 0;                ///< of the curve
  double area = 0;                  ///< of the patch
  double coverage = 0;              ///< share that the patch is of all that lies beside the curve within the radius
};

/// Maps the surface within `radius` of a curve one to one to the plane. The second coordinate is the distance from the
/// curve, exact at the mesh's vertices (up to 1e-4 of the radius) and linear between them; the first is the arc length
/// on the curve, and off it harmonic, so that it passes over bends, bumps and saddle vertices without jumps. Faces are
/// cut along the curve, where it ends (at right angles), at the radius and at the cut locus, across which the patch
/// does not hang together; they are divided where they are large beside the radius. Left out is what lies beyond the
/// ends of the curve, and what no map of this kind can hold: about places where the distance has a maximum. Of a closed
/// curve the map is cut open where it starts. \throw InputError for a radius that is not finite and above 0, or less
/// than 1/8000 of the curve's length (the map may take more than a million triangles), a curve of another mesh, a curve
/// that crosses or touches itself (telling where); Cancelled. O(n^1.5) for n vertices of the patch, and O(F).
StrokeMap stroke_map(const Mesh& mesh, const SurfaceCurve& curve, double radius, Job* job = nullptr);

}  // namespace saddleback
