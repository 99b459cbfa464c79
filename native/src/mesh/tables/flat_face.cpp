#include "mesh/tables/flat_face.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "saddleback/mesh/surface_points.h"

namespace saddleback {

FlatFace::FlatFace(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a;
  const double length = u.norm();
  corner[0] = Vec2(0, 0);
  corner[1] = Vec2(length, 0);
  corner[2] = Vec2(u.dot(v) / length, u.cross(v).norm() / length);
  last = corner[2] - corner[1];
  constexpr double k_short = 1.0 / 16;  // of the other sides
  if (last.squaredNorm() < k_short * k_short * length * length) last.x() = u.dot(c - b) / length;
  size = length + std::abs(corner[2].x()) + corner[2].y();
}

Vec3 FlatFace::to_barycentric(const Vec2& xy) const {
  const double b2 = xy.y() / corner[2].y();
  const double b1 = (xy.x() - b2 * corner[2].x()) / corner[1].x();
  return {1 - b1 - b2, b1, b2};
}

Vec3 snapped(const FlatFace& face, const Vec3& barycentric) {
  Vec3 b = barycentric;
  const double reach = k_snap * face.size;
  const double twice_area = face.corner[1].x() * face.corner[2].y();
  int nearest = 0;
  double nearest_distance = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const Vec2 next = face.corner[(i + 1) % 3] - face.corner[i], last = face.corner[(i + 2) % 3] - face.corner[i];
    if ((b[(i + 1) % 3] * next + b[(i + 2) % 3] * last).norm() <= reach) return Vec3::Unit(i);
    const double to_edge = b[i] * twice_area / (last - next).norm();
    if (to_edge < nearest_distance) nearest = i, nearest_distance = to_edge;
  }
  // Only the nearest edge: in a needle a point may be within reach of two edges and yet far from their corner.
  if (nearest_distance > reach || b[nearest] > 0.5) return normalized_barycentric(b);
  // To the foot on that edge: in a needle what the corner weighs, be it less than nothing, would move the point along
  // it.
  const int from = (nearest + 1) % 3, to = (nearest + 2) % 3;
  const Vec2 along = face.corner[to] - face.corner[from], there = face.corner[nearest] - face.corner[from];
  b[to] = std::clamp(b[to] + b[nearest] * (there.dot(along) / along.squaredNorm()), 0.0, 1.0);
  b[from] = 1 - b[to];
  b[nearest] = 0;
  return b;
}

}  // namespace saddleback
