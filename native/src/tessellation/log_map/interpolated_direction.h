#pragma once
// Directions between those of an edge's ends.

#include "saddleback/types.h"

namespace saddleback {

/// Returns where a point lies that is seen along `ray` across an edge, in the plane that has the edge's ends at `from`
/// and `to`. Ray and `to_start`, `to_end` lead, in the edge's own frame, from where it is seen to it and to the ends.
/// Its direction divides the angle between those of the ends as the ray divides it in the frame; it is as far away as
/// the ray is long where `from` is as far as `to_start`.
Vec2 seen_between(const Vec2& from, const Vec2& to, const Vec2& to_start, const Vec2& to_end, const Vec2& ray);

}  // namespace saddleback
