#pragma once
// A face laid out flat, and when a point of it counts as being on an edge or at a corner.

#include <array>

#include "saddleback/types.h"

namespace saddleback {

/// A line nearer to a corner than this share of the face's size meets it, and a point nearer to an edge or corner is on
/// it. Positions carry some 1e-16 of rounding for each face crossed, so 1e-13 covers a walk over thousands of faces and
/// is still below the lowest face that Mesh accepts.
inline constexpr double k_snap = 1e-13;

/// Corner 0 at the origin, corner 1 on the positive x axis, corner 2 above it.
struct FlatFace {
  Vec2 corner[3];
  Vec2 last;    ///< from corner 1 to corner 2, where that is short with more digits than their difference
  double size;  ///< bounds the coordinates; the scale of rounding

  /// Lays the face out from positions, not from the three lengths: dot and cross products keep a needle's short side
  /// accurate.
  FlatFace(const Vec3& a, const Vec3& b, const Vec3& c);
  explicit FlatFace(const std::array<Vec3, 3>& corners) : FlatFace(corners[0], corners[1], corners[2]) {}
  Vec3 to_barycentric(const Vec2& xy) const;
  /// Returns what leads from one place to another, by how much their barycentric coordinates differ: of a needle's
  /// short side, too, to a few roundings of it.
  Vec2 vector(const Vec3& change) const {
    if (last.squaredNorm() < corner[2].squaredNorm()) return change[2] * last - change[0] * corner[1];
    return change[1] * corner[1] + change[2] * corner[2];
  }
};

/// Barycentric coordinates with rounding removed, exactly at a corner or on an edge when within k_snap of it.
Vec3 snapped(const FlatFace& face, const Vec3& barycentric);

}  // namespace saddleback
