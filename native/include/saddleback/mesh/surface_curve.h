#pragma once
// Polylines on a mesh: checked once, cut into straight pieces of faces.

#include <optional>
#include <span>
#include <vector>

#include "saddleback/mesh/surface_points.h"

namespace saddleback {

/// A straight piece of a curve inside one closed face.
struct CurveSegment {
  Index face;
  Vec3 begin, end;  ///< barycentric in `face`
  double start;     ///< arc length of the curve at `begin`
  double length;    ///< > 0
};

/// A curve on the surface: straight between consecutive points, which share a face. Immutable; the mesh must outlive
/// it.
class SurfaceCurve {
 public:
  /// A closed curve runs on from the last point to the first. A point within k_barycentric_tolerance of an edge or a
  /// vertex counts as on it where the next point needs that. \throw InputError, naming `argument`, for fewer than two
  /// points, a point off the mesh, two consecutive points that share no face (naming their indices), a curve without
  /// length. O(n).
  SurfaceCurve(const Mesh& mesh, SurfacePoints points, bool closed = false, const char* argument = "points");

  const Mesh& mesh() const { return *mesh_; }
  const SurfacePoints& points() const { return points_; }
  bool closed() const { return closed_; }
  double length() const { return length_; }
  /// Lists them in order, without those of no length.
  std::span<const CurveSegment> segments() const { return segments_; }

 private:
  void add_segment(std::size_t from, std::size_t to, const char* argument);

  const Mesh* mesh_;
  SurfacePoints points_;
  std::vector<CurveSegment> segments_;
  bool closed_;
  double length_ = 0;
};

/// The point's barycentric coordinates in another face that it lies on, too (on a shared edge or vertex); none when it
/// does not. Coordinates up to `tolerance` count as zero.
std::optional<Vec3> barycentric_in(const Mesh& mesh, const SurfacePoint& point, Index face, double tolerance = 0);

/// A face that both points lie on, k_none when there is none. Of several the first point's own, then the second's;
/// before those on which they lie only within `tolerance` others.
Index shared_face(const Mesh& mesh, const SurfacePoint& a, const SurfacePoint& b, double tolerance = 0);

/// Length of the straight line between two points of one face; in space also between others, as the bird flies.
double step_length(const Mesh& mesh, const SurfacePoint& a, const SurfacePoint& b);

}  // namespace saddleback
