#include "voronoi2d/bisector.h"

#include <algorithm>
#include <cmath>

namespace saddleback::voronoi2d {

Bisector::Bisector(const Vec2& left, const Vec2& right, double weight) {
  const Vec2 half = 0.5 * right - 0.5 * left;
  const double length = half.stableNorm();
  const Vec2 across = half / length;
  middle_ = 0.5 * left + 0.5 * right;
  p_length_ = 0.5 * weight;
  q_length_ = std::sqrt(std::max(0.0, length - p_length_)) * std::sqrt(std::max(0.0, length + p_length_));
  p_ = p_length_ * across;
  q_ = q_length_ * Vec2(-across.y(), across.x());
}

Vec2 Bisector::at(double t) const { return middle_ + std::cosh(t) * p_ + std::sinh(t) * q_; }

double Bisector::parameter(const Vec2& point) const {
  return std::asinh((point - middle_).dot(q_ / q_length_) / q_length_);
}

Vec2 Bisector::end_direction(bool forwards) const {
  return (forwards ? Vec2(p_ + q_) : Vec2(p_ - q_)).stableNormalized();
}

double Bisector::parameter_beyond(double t, bool forwards, double length) const {
  const double sign = forwards ? 1 : -1, near = std::max(0.0, sign * t);
  const Vec2 apex = at(0);
  const double wanted = (at(sign * near) - apex).stableNorm() + length;
  // The curve leaves its middle at least as fast as q sinh t.
  double low = near, high = std::max(near, std::asinh(wanted / q_length_));
  constexpr int k_steps = 60;
  for (int step = 0; step < k_steps; ++step) {
    const double half = 0.5 * (low + high);
    ((at(sign * half) - apex).stableNorm() < wanted ? low : high) = half;
  }
  return sign * high;
}

// From the middle m of two parameters, h apart, the chord is (cosh(h / 2) - 1) |p x q| / |x'(m)| away, which is the
// farthest.
void Bisector::sample(double from, double to, double tolerance, std::vector<Vec2>& points) const {
  const double middle = 0.5 * (from + to), quarter = 0.25 * (to - from);
  const double speed = (std::sinh(middle) * p_ + std::cosh(middle) * q_).stableNorm();
  const double bulge = 2 * std::sinh(quarter) * std::sinh(quarter);  // cosh(h / 2) - 1
  if (!(bulge * std::fabs(p_length_) * (q_length_ / speed) > tolerance)) return;
  if (middle == from || middle == to) return;
  sample(from, middle, tolerance, points);
  points.push_back(at(middle));
  sample(middle, to, tolerance, points);
}

// With positions from the curve's own middle x x x' is constant, p x q, which makes the integrals elementary.
Bisector::Segment Bisector::segment(double from, double to) const {
  const double h = to - from, sine = std::sinh(0.5 * h);
  constexpr double k_short = 0.3;
  double rest = h - std::sinh(h);
  if (std::fabs(h) < k_short) {
    const double s = h * h;
    rest = -h * s / 6 * (1 + s / 20 * (1 + s / 42 * (1 + s / 72 * (1 + s / 110))));
  }
  const double cross = p_length_ * q_length_, area = 0.5 * cross * rest;
  const double m = 0.5 * (from + to);
  const Vec2 moment = (-2.0 / 3) * cross * sine * sine * sine * (std::cosh(m) * p_ + std::sinh(m) * q_);
  return {area, moment + area * middle_};
}

}  // namespace saddleback::voronoi2d
