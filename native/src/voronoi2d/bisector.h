#pragma once
// The curve between two cells: a branch of a hyperbola, a straight line between sites of equal weight.

#include <vector>

#include "saddleback/types.h"

namespace saddleback::voronoi2d {

/// Where |x - left| - |x - right| is the difference of the weights, as x(t) = middle + p cosh t + q sinh t, t growing
/// with the left site on the left. \pre Neither site hides the other.
class Bisector {
 public:
  /// `weight` is that of the left site less that of the right one.
  Bisector(const Vec2& left, const Vec2& right, double weight);

  Vec2 at(double t) const;
  /// Of a point of the curve.
  double parameter(const Vec2& point) const;
  /// Unit vector towards which the curve goes: for t to infinity, or outwards for t to minus infinity.
  Vec2 end_direction(bool forwards) const;
  /// Beyond a parameter, and beyond the middle of the branch, that of the point which is farther than these from the
  /// middle by a length.
  double parameter_beyond(double t, bool forwards, double length) const;
  /// Appends points between two parameters, the ends left out, so that chords are within a tolerance of the curve.
  void sample(double from, double to, double tolerance, std::vector<Vec2>& points) const;

  /// Area and first moment, about the origin, between the curve from one parameter to another and its chord; positive
  /// where the curve is on the right of the chord, as it is when the left site is the lighter one.
  struct Segment {
    double area;
    Vec2 moment;
  };
  Segment segment(double from, double to) const;

 private:
  Vec2 middle_, p_, q_;
  double p_length_, q_length_;
};

}  // namespace saddleback::voronoi2d
