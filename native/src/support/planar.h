#pragma once
// Small measures of the plane and of space.

#include <algorithm>
#include <cmath>
#include <limits>

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

/// Returns where the straight way from the origin to `target` crosses an edge, as a share of the edge; `at` is where it
/// has come to, and moves on. An edge that lies on the way is met where the way is already, and none beyond the target:
/// where a way passes a vertex by less than rounding, its edges may lead there.
inline double crossed_share(const Vec2& from, const Vec2& to, const Vec2& target, Vec2& at) {
  // The rounding of the area of a triangle of places on a way, as a share of the square of its length.
  constexpr double k_no_area = 16 * std::numeric_limits<double>::epsilon();
  const Vec2 along = to - from;
  const double squared = along.squaredNorm();
  // The areas of the triangles on either side of the way divide the edge as the way does.
  const double after = cross(to, target), before = cross(target, from), area = after + before;
  double share = 0.5;
  if (std::abs(area) > k_no_area * target.squaredNorm()) {
    share = before / area;
  } else if (squared > 0) {
    share = (at - from).dot(along) / squared;
  }
  share = std::clamp(share, 0.0, 1.0);
  constexpr double k_beyond = 1e-12;  // relative
  const double ahead = along.dot(target), most = target.squaredNorm() - from.dot(target);
  if (share * ahead > most + k_beyond * target.squaredNorm() && ahead != 0) share = std::clamp(most / ahead, 0.0, 1.0);
  at = from + share * along;
  return share;
}

}  // namespace saddleback
