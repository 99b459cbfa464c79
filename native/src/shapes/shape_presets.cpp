// Shapes of circumradius 1 from a few numbers.

#include <cmath>
#include <numbers>

#include "saddleback/error.h"
#include "saddleback/shapes/shape.h"

namespace saddleback::shapes {
namespace {

constexpr double k_pi = std::numbers::pi;
constexpr Index k_most_corners = 100'000;

Vec2 on_circle(double radius, double angle) { return {radius * std::cos(angle), radius * std::sin(angle)}; }

void check_count(const char* name, Index value, Index least) {
  if (value < least || value > k_most_corners)
    throw InputError(message(name, " is ", value, ", but must be ", least, " to ", k_most_corners));
}

void check_within(const char* name, double value, double low, double high) {
  if (!(value > low && value < high))
    throw InputError(message(name, " is ", value, ", but must be above ", low, " and below ", high));
}

/// count + 1 points of an arc, both ends included.
void add_arc(Shape::Loop& loop, const Vec2& center, double radius, double from, double to, Index count) {
  for (Index i = 0; i <= count; ++i) loop.push_back(center + on_circle(radius, from + (to - from) * i / count));
}

}  // namespace

Shape disk(Index corners) {
  check_count("corners", corners, 3);
  Shape::Loop loop;
  for (Index i = 0; i < corners; ++i) loop.push_back(on_circle(1, 2 * k_pi * i / corners));
  return Shape(std::move(loop));
}

Shape star(Index points, double inner) {
  check_count("points", points, 2);
  check_within("inner", inner, 0, 1);
  Shape::Loop loop;
  for (Index i = 0; i < 2 * points; ++i) loop.push_back(on_circle(i % 2 == 0 ? 1 : inner, k_pi * i / points));
  return Shape(std::move(loop));
}

Shape needle(double aspect) {
  if (!(aspect >= 1 && aspect <= 1e6)) throw InputError(message("aspect is ", aspect, ", but must be 1 to 1e6"));
  return Shape(Shape::Loop{{1, 0}, {0, 1 / aspect}, {-1, 0}, {0, -1 / aspect}});
}

Shape leaf(double aspect, Index corners) {
  check_within("aspect", aspect, 1, 1e6);
  check_count("corners", corners, 4);
  // The arc from (1, 0) over (0, 1 / aspect) to (-1, 0).
  const double height = 1 / aspect, radius = 0.5 * (1 + height * height) / height;
  const double half_angle = 2 * std::atan(height);
  const Index half = corners / 2;
  Shape::Loop loop;
  for (const double side : {1.0, -1.0})
    for (Index i = 0; i < half; ++i) {
      const double angle = half_angle * (1 - 2.0 * i / half);
      loop.push_back(side * Vec2(radius * std::sin(angle), radius * (std::cos(angle) - std::cos(half_angle))));
    }
  return Shape(std::move(loop));
}

Shape drop(double round, Index corners) {
  check_within("round", round, 0, 1);
  check_count("corners", corners, 4);
  // The disk about (round - 1, 0); the tangents from (1, 0) touch it at +-tangent.
  const Vec2 center(round - 1, 0);
  const double tangent = std::acos(std::min(1.0, round / (2 - round)));
  Shape::Loop loop{{1, 0}};
  add_arc(loop, center, round, tangent, 2 * k_pi - tangent, corners - 2);
  return Shape(std::move(loop));
}

Shape crescent(double inner, double shift, Index corners) {
  check_within("inner", inner, 0, 1 + 1e-12);
  check_within("shift", shift, 1 - inner, 1 + inner);
  check_count("corners", corners, 6);
  // The circles cross at the angle `outer` of the outer one and `bite` of the inner one.
  const double x = (1 + shift * shift - inner * inner) / (2 * shift);
  const double y = std::sqrt(std::max(0.0, 1 - x * x));
  const double outer = std::atan2(y, x), bite = std::atan2(y, x - shift);
  const Index half = corners / 2;
  Shape::Loop loop;
  add_arc(loop, Vec2::Zero(), 1, outer, 2 * k_pi - outer, half);
  Shape::Loop back;
  add_arc(back, Vec2(shift, 0), inner, -bite, bite - 2 * k_pi, half);
  loop.insert(loop.end(), back.begin() + 1, back.end() - 1);
  return Shape(std::move(loop));
}

}  // namespace saddleback::shapes
