#pragma once
// On which side of a plane a point lies.

#include "saddleback/types.h"

namespace saddleback::predicates {

/// Returns 1 where `d` sees a, b, c turn clockwise, -1 where it sees them turn counter-clockwise, 0 where all four lie
/// in one plane: exactly, for finite numbers whose products neither over- nor underflow. In doubles where their
/// rounding cannot matter, which is nearly always. After [shewchuk1997].
int orient_3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace saddleback::predicates
