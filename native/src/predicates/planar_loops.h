#pragma once
// Closed polygons of the plane, decided exactly: whether they touch, which side a point is on.

#include <optional>
#include <span>
#include <vector>

#include "saddleback/types.h"

namespace saddleback::predicates {

using Loop = std::vector<Vec2>;  ///< corners, the last joined to the first

/// Returns twice the area, positive when counter-clockwise; summed up from the first corner, not exact.
double twice_area(const Loop& loop);

/// Tells exactly whether a ray to the right crosses the loop an odd number of times. O(m).
bool is_inside(const Loop& loop, const Vec2& point);

/// Tells exactly whether two closed segments have a point in common.
bool segments_touch(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

/// The first two edges that have more in common than a corner that joins them.
struct LoopMeeting {
  Index loop, corner;  ///< the edge after this corner
  Index other_loop, other_corner;
};
/// Finds, exactly, the first two pieces of loops that meet. If `may_touch`, loops may have a point in common with other
/// loops where they do not go through them. O(m log m) expected for m corners in all, none of which equals the next.
std::optional<LoopMeeting> first_meeting(std::span<const Loop> loops, bool may_touch = false);

}  // namespace saddleback::predicates
