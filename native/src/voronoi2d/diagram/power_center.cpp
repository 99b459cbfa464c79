#include "voronoi2d/diagram/power_center.h"

#include <algorithm>
#include <cmath>

#include "predicates/exact_number.h"

namespace saddleback::voronoi2d {

using predicates::ExactNumber;
using predicates::PowerPoint2;

namespace {

/// Solves by Cramer's rule, in differences from the first site: the way to the center is (x, y) over twice `det`.
template <class Number, class Difference>
void solve(const PowerPoint2& a, const PowerPoint2& b, const PowerPoint2& c, const Difference& difference, Number& x,
           Number& y, Number& det) {
  const Number bx = difference(b.x, a.x), by = difference(b.y, a.y), cx = difference(c.x, a.x),
               cy = difference(c.y, a.y);
  const Number b_lift = bx * bx + by * by - difference(b.weight, a.weight),
               c_lift = cx * cx + cy * cy - difference(c.weight, a.weight);
  x = cy * b_lift - by * c_lift;
  y = bx * c_lift - cx * b_lift;
  det = bx * cy - by * cx;
}

/// A double and how much its rounding may have changed it, in units of the last place of 1.
struct Rounded {
  double value, error;
};
Rounded operator+(const Rounded& a, const Rounded& b) {
  const double sum = a.value + b.value;
  return {sum, a.error + b.error + std::fabs(sum)};
}
Rounded operator-(const Rounded& a, const Rounded& b) { return a + Rounded{-b.value, b.error}; }
Rounded operator*(const Rounded& a, const Rounded& b) {
  const double product = a.value * b.value;
  return {product, std::fabs(a.value) * b.error + std::fabs(b.value) * a.error + std::fabs(product)};
}

}  // namespace

Vec2 power_center(const PowerPoint2& a, const PowerPoint2& b, const PowerPoint2& c) {
  Rounded x, y, det;
  solve(
      a, b, c,
      [](double p, double q) {
        return Rounded{p - q, std::fabs(p - q)};
      },
      x, y, det);
  // A few bits more are lost where terms cancel; beyond that all are kept.
  constexpr double k_most = 64;
  const double size = std::max(std::fabs(x.value), std::fabs(y.value));
  if (det.error < k_most * std::fabs(det.value) && std::max(x.error, y.error) < k_most * size)
    return {a.x + 0.5 * (x.value / det.value), a.y + 0.5 * (y.value / det.value)};
  ExactNumber exact_x, exact_y, exact_det;
  solve(
      a, b, c, [](double p, double q) { return ExactNumber(p) - ExactNumber(q); }, exact_x, exact_y, exact_det);
  const double twice = 2 * exact_det.to_double();
  return {a.x + exact_x.to_double() / twice, a.y + exact_y.to_double() / twice};
}

}  // namespace saddleback::voronoi2d
