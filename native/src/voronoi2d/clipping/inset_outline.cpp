// The curve of points at a distance from a branch of a hyperbola is convex as the branch is. On its convex side it goes
// around the branch; on its concave side, farther than the least radius of curvature, it has a corner on the axis,
// where the points beside both arms meet.

#include "voronoi2d/clipping/inset_outline.h"

#include <algorithm>
#include <cmath>

#include "support/hypotenuse.h"
#include "support/planar.h"

namespace saddleback::voronoi2d {
namespace {

Vec2 left_of(const Vec2& way) { return {-way.y(), way.x()}; }

/// The points beside a bisector, on its left.
struct Beside {
  const Bisector& curve;
  double distance;

  Vec2 way(double t) const { return curve.slope(t).stableNormalized(); }
  Vec2 at(double t) const { return curve.at(t) + distance * left_of(way(t)); }

  /// Appends points between two, the ends left out. A convex arc that turns by less than a right angle lies in a
  /// triangle on its chord, at most as high as that with equal sides. \pre The arc turns by a right angle at most.
  void divide(double from, double to, double tolerance, Loop& points) const {
    const double middle = 0.5 * (from + to);
    if (middle == from || middle == to) return;
    const Vec2 begin = way(from), end = way(to);
    const double turned = std::fabs(cross(begin, end)) / (1 + begin.dot(end));  // tan of half the angle
    if (0.5 * (at(to) - at(from)).stableNorm() * turned <= tolerance) return;
    divide(from, middle, tolerance, points);
    add_point(points, at(middle));
    divide(middle, to, tolerance, points);
  }
};

/// The parameter from which on a point beside the curve has its nearest point of the curve there: 0 unless the curve is
/// bent to the left, farther away than its least radius of curvature. Both sides of the axis are alike.
double first_parameter(const Bisector& curve, double distance) {
  const double p = -curve.p_length(), q = curve.q_length();
  if (!(p > 0) || !(distance * p > q * q)) return 0;
  const double length = hypotenuse(p, q), crossing = distance * (p / q);
  return std::asinh(std::sqrt((crossing - q) / length) * std::sqrt((crossing + q) / length));
}

/// Closes an outline far out on the left; where its ends have come back to the right, around these.
void add_far_corners(const Bisector& curve, double reach, Loop& loop) {
  const Vec2 along = curve.slope(0).stableNormalized(), left = left_of(along);
  const Vec2 begin = loop.front() - curve.middle(), end = loop.back() - curve.middle();
  const double far = 2 * reach;
  const auto add = [&](double aside, double ahead) { add_point(loop, curve.middle() + aside * left + ahead * along); };
  const auto add_corner = [&](const Vec2& way, double ahead) {
    const double aside = way.dot(left);
    if (aside < 0) {
      add(far, ahead);
    } else {
      add(std::max(far, aside), way.dot(along));
    }
  };
  if (end.dot(left) < 0) add(end.dot(left), far);
  add_corner(end, far);
  add_corner(begin, -far);
  if (begin.dot(left) < 0) add(begin.dot(left), -far);
}

}  // namespace

Loop inset_outline(const Bisector& curve, double distance, double tolerance, const Vec2& center, double radius) {
  // The curve leaves the middle of its sites at least as fast as its half focal distance times sinh t.
  const double reach = 2 * ((center - curve.middle()).norm() + radius + distance);
  const double last = std::asinh(reach / hypotenuse(curve.p_length(), curve.q_length()));
  const double first = first_parameter(curve, distance);
  if (first >= last) return {};
  constexpr double k_finest = 0x1p-40;  // also where the tolerance is less than any double
  tolerance = std::max(tolerance, k_finest * reach);
  const Beside beside{curve, distance};
  Loop loop{beside.at(-last)};
  beside.divide(-last, -first, tolerance, loop);
  if (first > 0) {  // the corner on the axis, by rounding perhaps not quite
    add_point(loop, 0.5 * (beside.at(-first) + beside.at(first)));
  } else {
    add_point(loop, beside.at(0));
  }
  beside.divide(first, last, tolerance, loop);
  add_point(loop, beside.at(last));
  add_far_corners(curve, reach, loop);
  return loop;
}

}  // namespace saddleback::voronoi2d
