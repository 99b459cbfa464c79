#pragma once
// All directions about a point of the surface, and the rays that leave it in some of them.

#include <vector>

#include "saddleback/mesh/surface_points.h"

#include "geodesics/wavefront/wavefront_distances.h"

namespace saddleback {

/// The faces about a point, in the order of the directions that lead into them. Directions are surface angles: in the
/// FaceChart of the point's face or, at a vertex, from first_halfedge, as `trace` takes them.
class DirectionsAtPoint {
 public:
  DirectionsAtPoint(const Unfolding& unfolding, const SurfacePoint& point);

  Index vertex() const { return vertex_; }  ///< k_none when the point is none
  double total_angle() const { return total_; }
  /// Tells whether directions go all round: not on the boundary.
  bool is_round() const { return round_; }
  /// First direction; the last is begin + total_angle.
  double begin() const { return sectors_.front().begin; }
  /// A direction given in the FaceChart of one of the faces.
  double angle_of(Index face, double chart_angle) const;

  /// Sends the rays between two directions (begin <= end) into the field. `window` says what they are and tell; the
  /// rest of it is filled in. The angle that Rays::from_point tell is the direction.
  void emit(WavefrontDistances& field, const RayWindow& window, double begin, double end) const;

 private:
  struct Sector {
    Index face;
    Index leaving;       ///< half-edge from the vertex, k_none for other points
    double begin, size;  ///< directions
    double chart_begin;  ///< of the first direction in the face's chart
  };
  void emit_into(WavefrontDistances& field, const RayWindow& window, const Sector& sector, double begin,
                 double end) const;
  void emit_from_corner(WavefrontDistances& field, RayWindow window, const Sector& sector, double begin,
                        double end) const;
  void emit_inside(WavefrontDistances& field, RayWindow window, const Sector& sector, double begin, double end) const;

  const Unfolding& unfolding_;
  const Mesh& mesh_;
  SurfacePoint point_;
  Index vertex_ = k_none;
  double total_ = 0;
  bool round_ = true;
  std::vector<Sector> sectors_;
};

/// Surface angle, at corner `h` of a face (h leaves it), of the direction to a place in the face's chart.
double angle_at_corner(const Unfolding& unfolding, Index h, const FaceChart& chart, const Vec2& place);

}  // namespace saddleback
