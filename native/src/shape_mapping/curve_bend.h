#pragma once
// The bending of a curve on a surface within it.

#include <span>
#include <vector>

#include "saddleback/mesh/surface_curve.h"

namespace saddleback {

/// Heading of a curve relative to where it begins, as if the faces along it were unfolded.
class CurveBend {
 public:
  /// Coordinates along the curve are counted from `origin`. O(segments).
  void measure(const SurfaceCurve& curve, double origin);

  /// Mean geodesic curvature within `reach` of a place, radians per length, positive to the left; 0 beyond the ends.
  /// O(log segments).
  double curvature(double place, double reach) const;

 private:
  double heading(double place) const;

  std::vector<double> places_, headings_;  ///< of the middles of segments
};

}  // namespace saddleback
