// The ray's angle from the edge's start is kept, and of what the two planes' angles between the ends differ by, which
// is little on any surface that is nearly flat across an edge, the ray gets its share.

#include "tessellation/log_map/interpolated_direction.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "support/planar.h"

namespace saddleback {
namespace {

Vec2 rotated(const Vec2& v, double c, double s) { return {c * v.x() - s * v.y(), s * v.x() + c * v.y()}; }

/// The angle of (x, y) to 1e-5, where it is a share of a small one that is wanted (Abramowitz and Stegun 4.4.47).
double rough_angle(double x, double y) {
  const double across = std::abs(x), up = std::abs(y);
  const double t = std::min(across, up) / std::max({across, up, std::numeric_limits<double>::min()}), s = t * t;
  double angle = t * (0.9998660 + s * (-0.3302995 + s * (0.1801410 + s * (-0.0851330 + s * 0.0208351))));
  if (up > across) angle = std::numbers::pi / 2 - angle;
  if (x < 0) angle = std::numbers::pi - angle;
  return y < 0 ? -angle : angle;
}

/// Turned by an angle that is small nearly always.
Vec2 turned(const Vec2& v, double angle) {
  constexpr double k_small = 1e-2;  // the next term of the series is below rounding
  if (std::abs(angle) > k_small) return rotated(v, std::cos(angle), std::sin(angle));
  const double s = angle * angle;
  return rotated(v, 1 - s / 2 * (1 - s / 12 * (1 - s / 30)), angle * (1 - s / 6 * (1 - s / 20 * (1 - s / 42))));
}

}  // namespace

Vec2 seen_between(const Vec2& from, const Vec2& to, const Vec2& to_start, const Vec2& to_end, const Vec2& ray) {
  constexpr double k_small = 1e-2;
  const double ray_x = to_start.dot(ray), ray_y = cross(to_start, ray);
  const double frame_x = to_start.dot(to_end), frame_y = cross(to_start, to_end);
  const double plane_x = from.dot(to), plane_y = cross(from, to);
  const double x = plane_x * frame_x + plane_y * frame_y, y = plane_y * frame_x - plane_x * frame_y;
  const double ratio = y / x;
  double turn;
  if (x > 0 && std::abs(ratio) < k_small) {
    const double difference = ratio * (1 - ratio * ratio / 3);
    turn = difference == 0 ? 0 : difference * (rough_angle(ray_x, ray_y) / rough_angle(frame_x, frame_y));
  } else {
    turn = std::atan2(y, x) * (std::atan2(ray_y, ray_x) / std::atan2(frame_y, frame_x));
  }
  return turned(rotated(from, ray_x, ray_y) / to_start.squaredNorm(), turn);
}

}  // namespace saddleback
