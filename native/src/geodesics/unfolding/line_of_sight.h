#pragma once
// The straight geodesic between two points of the surface that see each other.

#include <vector>

#include "saddleback/mesh/surface_points.h"

#include "geodesics/unfolding/unfolding.h"

namespace saddleback {

/// Follows windows from one point towards another, as ArcUnfolder does between vertices, only through edges that a path
/// no longer than the bound can cross. Holds its scratch memory; one a thread.
class LineOfSight {
 public:
  /// `is_exact`: whether little may be given up. Along thin tubes, whose far ends are near each other in space,
  /// a bound leaves many windows.
  explicit LineOfSight(bool is_exact) : most_windows_(is_exact ? 100'000 : 10'000) {}
  /// Length of the shortest straight geodesic between two points inside faces or on edges, if it is less than `upper`;
  /// else `upper`. Equal to the bit from both ends: it is always sought from the point that comes first (face, then
  /// coordinates). O(faces within the ellipse about both), given up after a number of windows.
  double length(const Unfolding& unfolding, const SurfacePoint& a, const SurfacePoint& b, double upper);
  /// The half-edges that the last geodesic found crosses, from a to b, each of the face that is entered; none when the
  /// points share a face.
  const std::vector<Index>& entered() const { return entered_; }

 private:
  /// Half-edge about to be entered, its ends in the plane of the first point at the origin, and the part in sight.
  struct Window {
    Index entered;
    Index depth;  ///< half-edges entered before
    Vec2 from, to;
    Vec2 right, left;  ///< left is counter-clockwise of right
  };

  void set_out(const Mesh& mesh, const SurfacePoint& point);
  void push(const Mesh& mesh, Index edge, Index depth, const Vec2& from, const Vec2& to, const Vec2& right,
            const Vec2& left);

  int most_windows_;
  std::vector<Window> stack_;
  std::vector<Index> trail_, entered_;
};

}  // namespace saddleback
