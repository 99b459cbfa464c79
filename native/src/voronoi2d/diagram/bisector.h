#pragma once
// The curve between two cells: a branch of a hyperbola, a straight line between sites of equal weight.

#include <vector>

#include "saddleback/types.h"

#include "predicates/weighted_point.h"

namespace saddleback::voronoi2d {

using predicates::WeightedPoint2;

/// Describes where |x - left| - |x - right| is the difference of the weights, as x(t) = middle + p cosh t + q sinh t, t
/// growing with the left site on the left. \pre Neither site hides the other.
class Bisector {
 public:
  /// Makes it in coordinates that count from `origin`.
  Bisector(const WeightedPoint2& left, const WeightedPoint2& right, const Vec2& origin = Vec2(0, 0));

  Vec2 at(double t) const;
  Vec2 slope(double t) const;
  const Vec2& middle() const { return middle_; }
  /// Returns the length of p, negative where the curve is bent to the left.
  double p_length() const { return p_length_; }
  double q_length() const { return q_length_; }
  /// Returns the parameter of a point of the curve.
  double parameter(const Vec2& point) const;
  /// Unit vector towards which the curve goes: for t to infinity, or outwards for t to minus infinity.
  Vec2 end_direction(bool forwards) const;
  /// Returns the one beyond a parameter, and beyond the middle of the branch, that of the point which is farther than
  /// these from the middle by a length.
  double parameter_beyond(double t, bool forwards, double length) const;
  /// Appends points between two parameters, the ends left out, so that each point of the curve is within a tolerance of
  /// a chord; one finer than a share of 2^-40 of what the curve spans is taken as that, which some 2^19 points reach at
  /// most.
  void sample(double from, double to, double tolerance, std::vector<Vec2>& points) const;

  /// Area and first moment, about the origin, between the curve from one parameter to another and its chord; positive
  /// where the curve is on the right of the chord, as it is when the left site is the lighter one.
  struct Segment {
    double area;
    Vec2 moment;
  };
  Segment segment(double from, double to) const;

 private:
  double farthest_from_chord(double from, double to) const;
  /// Divides a part of the curve that goes farther than that from its chord.
  void divide(double from, double to, double tolerance, std::vector<Vec2>& points) const;

  Vec2 middle_, p_, q_;
  double p_length_, q_length_;
};

}  // namespace saddleback::voronoi2d
