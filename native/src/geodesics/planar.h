#pragma once
// Small measures of the plane and of space.

#include <algorithm>

#include "saddleback/types.h"

namespace saddleback {

inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

template <class Vector>
double distance_to_segment(const Vector& point, const Vector& from, const Vector& to) {
  const Vector along = to - from;
  const double squared = along.squaredNorm();
  const double part = squared > 0 ? std::clamp((point - from).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (from + part * along - point).norm();
}

}  // namespace saddleback
