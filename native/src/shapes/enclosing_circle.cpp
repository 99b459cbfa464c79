#include "shapes/enclosing_circle.h"

#include <algorithm>

namespace saddleback::distribution {
namespace {

/// A point this much (relative) outside of a circle counts as on it.
constexpr double k_rounding = 1e-12;

bool holds(const Circle& circle, const Vec2& point) {
  return (point - circle.center).norm() <= circle.radius * (1 + k_rounding);
}

Circle through(const Vec2& a, const Vec2& b) { return {0.5 * (a + b), 0.5 * (b - a).norm()}; }

Circle through(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 p = b - a, q = c - a;
  const double twice_cross = 2 * (p.x() * q.y() - p.y() * q.x());
  if (twice_cross == 0) {  // on one line: the two farthest apart
    Circle widest = through(a, b);
    for (const Circle& other : {through(a, c), through(b, c)})
      if (other.radius > widest.radius) widest = other;
    return widest;
  }
  const Vec2 center(q.y() * p.squaredNorm() - p.y() * q.squaredNorm(),
                    p.x() * q.squaredNorm() - q.x() * p.squaredNorm());
  return {a + center / twice_cross, (center / twice_cross).norm()};
}

}  // namespace

Circle enclosing_circle(std::span<const Vec2> points) {
  Circle circle{points[0], 0};
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (holds(circle, points[i])) continue;
    circle = {points[i], 0};
    for (std::size_t j = 0; j < i; ++j) {
      if (holds(circle, points[j])) continue;
      circle = through(points[i], points[j]);
      for (std::size_t k = 0; k < j; ++k)
        if (!holds(circle, points[k])) circle = through(points[i], points[j], points[k]);
    }
  }
  return circle;
}

}  // namespace saddleback::distribution
