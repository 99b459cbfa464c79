#include "voronoi2d/diagram/bisector.h"

#include <algorithm>
#include <cmath>

#include "predicates/expansion.h"
#include "support/hypotenuse.h"

namespace saddleback::voronoi2d {

namespace {

/// The length of q: half the root of |right - left|^2 - weight^2, from the numbers as they were given, which matter
/// where the two squares nearly cancel.
double exact_q_length(const predicates::WeightedPoint2& left, const predicates::WeightedPoint2& right, double unit) {
  using namespace predicates;
  const auto x = difference(left.x * unit, right.x * unit), y = difference(left.y * unit, right.y * unit),
             w = difference(left.weight * unit, right.weight * unit);
  const auto square = sum(sum(product(x, x), product(y, y)), product(w, w), -1);
  double total = 0;
  for (int i = 0; i < square.size; ++i) total += square.terms[i];
  return 0.5 * std::sqrt(std::max(0.0, total)) / unit;
}

}  // namespace

Bisector::Bisector(const WeightedPoint2& left, const WeightedPoint2& right, const Vec2& origin) {
  const Vec2 from = Vec2(left.x, left.y) - origin, to = Vec2(right.x, right.y) - origin, half = 0.5 * to - 0.5 * from;
  const double length = half.stableNorm();
  const Vec2 across = half / length;
  middle_ = 0.5 * from + 0.5 * to;
  p_length_ = 0.5 * (left.weight - right.weight);
  constexpr double k_thin = 0x1p-6;
  q_length_ = length - std::fabs(p_length_) > k_thin * length
                  ? std::sqrt(std::max(0.0, length - p_length_)) * std::sqrt(std::max(0.0, length + p_length_))
                  : exact_q_length(left, right, std::ldexp(1, -std::ilogb(length)));
  p_ = p_length_ * across;
  q_ = q_length_ * Vec2(-across.y(), across.x());
}

Vec2 Bisector::at(double t) const { return middle_ + std::cosh(t) * p_ + std::sinh(t) * q_; }

// Along a thin curve the larger coordinate tells more, but near its middle.
double Bisector::parameter(const Vec2& point) const {
  const Vec2 along = q_ / q_length_, way = point - middle_;
  const double sine = way.dot(along) / q_length_;
  if (std::fabs(p_length_) > q_length_ && std::fabs(sine) > 1) {
    const double cosine = way.dot(Vec2(along.y(), -along.x())) / p_length_;
    if (cosine > 1) return std::copysign(std::acosh(cosine), sine);
  }
  return std::asinh(sine);
}

Vec2 Bisector::slope(double t) const { return std::sinh(t) * p_ + std::cosh(t) * q_; }

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

// From the middle m of two parameters, h apart, the chord is (cosh(h / 2) - 1) |p x q| / |x'(m)| away, the farthest
// from its line. Where the curve turns back by more than a right angle it also goes beyond the chord's end, up to where
// its slope is at a right angle to the chord, as tanh t = -(q / p)^2 / tanh m.
double Bisector::farthest_from_chord(double from, double to) const {
  const double middle = 0.5 * (from + to), quarter = 0.25 * (to - from);
  const Vec2 slope_there = slope(middle);
  const double speed = slope_there.stableNorm();
  const double bulge = 2 * std::sinh(quarter) * std::sinh(quarter);  // cosh(h / 2) - 1
  const double distance = bulge * std::fabs(p_length_) * (q_length_ / speed);
  if (from * to >= 0 || std::fabs(p_length_) <= q_length_) return distance;  // it does not turn back
  const Vec2 along = slope_there / speed;
  for (const double end : {from, to}) {
    if (!(slope(end).dot(along) < 0)) continue;
    const double ratio = q_length_ / p_length_, turn = std::atanh(-ratio * ratio / std::tanh(middle));
    return hypotenuse(distance, (at(turn) - at(end)).dot(along));
  }
  return distance;
}

void Bisector::sample(double from, double to, double tolerance, std::vector<Vec2>& points) const {
  const double farthest = farthest_from_chord(from, to);
  if (!(farthest > tolerance)) return;
  constexpr double k_many = 0x1p10, k_finest = 0x1p-40;
  if (farthest > k_many * tolerance) {
    const Vec2 middle = at(std::clamp(0.0, std::min(from, to), std::max(from, to)));
    const double span = (at(from) - middle).stableNorm() + (at(to) - middle).stableNorm();
    tolerance = std::max(tolerance, k_finest * span);
  }
  divide(from, to, tolerance, points);
}

void Bisector::divide(double from, double to, double tolerance, std::vector<Vec2>& points) const {
  const double middle = 0.5 * (from + to);
  if (middle == from || middle == to) return;
  if (farthest_from_chord(from, middle) > tolerance) divide(from, middle, tolerance, points);
  points.push_back(at(middle));
  if (farthest_from_chord(middle, to) > tolerance) divide(middle, to, tolerance, points);
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
