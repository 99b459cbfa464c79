#pragma once
// Coordinates of a triangle's apex from those of its edge.

#include <array>
#include <cmath>

#include "saddleback/types.h"

#include "support/planar.h"

namespace saddleback {

/// A triangle unfolded: its edge from the origin along the x axis, the apex above it.
struct UnfoldedTriangle {
  double edge;
  Vec2 apex;
  UnfoldedTriangle(double length, const Vec2& top) : edge(length), apex(top) {}
  /// Corners: of the edge, then the apex.
  explicit UnfoldedTriangle(const std::array<Vec3, 3>& corners) {
    const Vec3 u = corners[1] - corners[0], v = corners[2] - corners[0];
    edge = u.norm();
    apex = Vec2(u.dot(v), u.cross(v).norm()) / edge;
  }
};

/// Returns where the apex comes to lie when the triangle is laid beside the places of its edge's ends.
inline Vec2 beside(const UnfoldedTriangle& triangle, const Vec2& from, const Vec2& to) {
  const Vec2 along = (to - from) / triangle.edge;
  return from + triangle.apex.x() * along + triangle.apex.y() * Vec2(-along.y(), along.x());
}

/// Holds what the apex sees of the source.
struct Sight {
  Vec2 place;
  /// Says by how much the line of sight misses the edge, in lengths of the edge: 0 when it passes through.
  double miss;
};

/// Misses up to this are rounding.
inline constexpr double k_sight = 1e-9;
/// The apex counts as out of sight from here on, and is laid beside the edge.
inline constexpr double k_most_miss = 0.5;

/// An edge as long as the places of its ends say, up to this share of their distances, lies on a flat surface.
inline constexpr double k_flat = 1e-13;

/// Returns where along an edge of length 1 a line crosses: how far beside it.
inline double miss_of(double hit) {
  const double miss = hit < 0 ? -hit : hit > 1 ? hit - 1 : 0;
  return miss <= k_sight ? 0 : miss;
}

/// The source is the origin of the plane: it is put where its distances from both ends say, and the apex in the same
/// place between the directions of the two ends as seen from there, or beside them.
inline Sight sight_of_point(const UnfoldedTriangle& triangle, const Vec2& from, const Vec2& to) {
  const Vec2 along = to - from;
  const double e = triangle.edge, product = from.norm() * to.norm(), twice_area = cross(from, along);
  // By how much the edge is longer than the places say. What rounding may be counts as flat: seen along a short edge
  // the source would move by the root of it.
  double bend = e - along.norm();
  if (std::abs(bend) <= k_flat * (from.norm() + to.norm())) bend = 0;
  bend *= e + along.norm();
  // The source's triangle has sides |from|, |to| and e. Differences of squares would lose the digits of a short edge.
  const double x = (e - along.dot(from + to) / e) / 2;
  const double y2 = (twice_area * twice_area + bend * (from.dot(to) - bend / 4)) / (e * e);
  const Vec2 aside = beside(triangle, from, to);
  const bool is_behind = twice_area <= 0;  // the edge lies between the source and the apex
  if (!is_behind || !(y2 >= -k_sight * from.squaredNorm())) return {aside, k_most_miss};
  const double y = std::sqrt(std::max(0.0, y2));
  const Vec2 to_apex(triangle.apex.x() - x, triangle.apex.y() + y);
  const double miss = miss_of((x + to_apex.x() * (y / to_apex.y())) / e);
  if (!(miss < k_most_miss)) return {aside, k_most_miss};
  // The ends and the apex as seen from the source. Where the edge is seen under a wide angle the mean of directions
  // would not be that of the apex; there the surface is nearly flat, or the mesh far too coarse for the shape.
  const Vec2 to_from(-x, y), to_to(e - x, y);
  const bool is_wide = to_from.dot(to_to) < 0.5 * product;
  const Vec2 direction = is_wide ? aside : Vec2(e * to_apex.y() * from + cross(to_apex, to_from) * along);
  const double length = direction.norm();
  if (!(length > 0)) return {aside, k_most_miss};
  return {direction * (to_apex.norm() / length), miss};
}

/// A bend by less than this over an edge counts as none: the distances to its center would lose too many digits.
inline constexpr double k_straight = 1e-6;

/// The source is the x axis, which stands for a curve that bends by `curvature` beside the edge. Along a straight one
/// distance grows evenly across the triangle; along a circle it grows from the circle's center, or towards it. The foot
/// stays where it is along the way.
inline Sight sight_of_line(const UnfoldedTriangle& triangle, const Vec2& from, const Vec2& to, double curvature) {
  const double side = from.y() + to.y() < 0 ? -1 : 1, e = triangle.edge;
  const bool is_behind = side * (to.x() - from.x()) >= 0 && side * from.y() >= 0 && side * to.y() >= 0;
  const auto unseen = [&] { return Sight{beside(triangle, from, to), k_most_miss}; };
  if (!is_behind) return unseen();
  double share = 0, height = 0;
  if (std::abs(curvature) * e < k_straight) {
    const double slope = side * (to.y() - from.y()) / e;
    if (!(std::abs(slope) < 1)) return unseen();
    const double rise = std::sqrt(1 - slope * slope);
    share = (triangle.apex.x() - slope * (triangle.apex.y() / rise)) / e;
    height = from.y() + side * (slope * triangle.apex.x() + rise * triangle.apex.y());
  } else {
    const double radius = 1 / curvature, sign = curvature < 0 ? -1 : 1;
    const double r_from = sign * (radius - from.y()), r_to = sign * (radius - to.y());
    const double x = (r_from * r_from - r_to * r_to + e * e) / (2 * e), y2 = r_from * r_from - x * x;
    if (!(r_from > 0 && r_to > 0 && y2 >= 0)) return unseen();
    // The center lies beyond the apex on the inner side of the bend, behind the edge on the outer one.
    const Vec2 center(x, side * sign * std::sqrt(y2));
    const Vec2 to_from = -center, to_to = Vec2(e, 0) - center, to_apex = triangle.apex - center;
    const double whole = std::atan2(cross(to_from, to_to), to_from.dot(to_to));
    if (whole == 0) return unseen();
    share = std::atan2(cross(to_from, to_apex), to_from.dot(to_apex)) / whole;
    height = radius - sign * to_apex.norm();
  }
  const double miss = miss_of(share);
  if (!(miss < k_most_miss)) return unseen();
  return {Vec2((1 - share) * from.x() + share * to.x(), height), miss};
}

}  // namespace saddleback
