#pragma once
// Windows of rays that leave a point, or a curve at right angles.

#include <cstdint>

#include "saddleback/types.h"

namespace saddleback {

/// Says how the rays of a window run, and what they tell of a place beside its distance.
enum class Rays : std::uint8_t {
  from_point,     ///< out of one point; they tell the angle in which they left it
  from_foot,      ///< out of one point; all tell the same value
  perpendicular,  ///< parallel, at right angles to a straight piece of curve; they tell the arc length of their foot
};

/// Part [b0, b1] of half-edge h, about to enter h's face, in the frame of h: from(h) at the origin, to(h) on the
/// positive x axis, the face above.
struct RayWindow {
  Vec2 source;  ///< unfolded point of departure (y <= 0); of perpendicular rays their unit direction (y > 0)
  double b0, b1;
  double offset;  ///< distance at the point of departure; of perpendicular rays at the frame's origin
  double value;   ///< from_point: angle, at the point, of the x axis; from_foot: the value; else that at the origin
  Index halfedge;
  Rays rays;
  std::int8_t side;  ///< of the curve: 1 left, -1 right, 0 neither
  bool shadowed;     ///< the rays set out anew at a saddle vertex
};

}  // namespace saddleback
