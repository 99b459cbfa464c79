#pragma once
// The distance of a point of the plane from a shape.

#include <vector>

#include "saddleback/shapes/shape.h"

namespace saddleback::distribution {

/// Distance to a shape's outline, negative within. A grid answers quickly, the edges exactly (up to rounding).
class SignedDistance {
 public:
  /// The grid reaches `margin` beyond the circumradius. O(cells * corners).
  SignedDistance(const Shape& shape, double margin);

  /// O(corners).
  double exact(const Vec2& point) const;

  /// The direction in which the distance falls fastest. O(corners).
  Vec2 way_in(const Vec2& point) const {
    const double step = 1e-4 * reach_;
    const Vec2 right(step, 0), up(0, step);
    return Vec2(exact(point - right) - exact(point + right), exact(point - up) - exact(point + up)).stableNormalized();
  }

  /// Returns a bound not below the exact value, and above by at most `slack`; infinite beyond the grid. O(1).
  double upper(const Vec2& point) const {
    const double x = (point.x() + reach_) * per_unit_, y = (point.y() + reach_) * per_unit_;
    if (!(x >= 0 && y >= 0 && x < k_cells && y < k_cells)) return k_far;
    const auto i = static_cast<Index>(x), j = static_cast<Index>(y);
    const double u = x - i, v = y - j;
    const float* const at = values_.data() + static_cast<std::size_t>(j) * (k_cells + 1) + i;
    const double low = static_cast<double>(at[0]) * (1 - u) + static_cast<double>(at[1]) * u;
    const double high = static_cast<double>(at[k_cells + 1]) * (1 - u) + static_cast<double>(at[k_cells + 2]) * u;
    return low * (1 - v) + high * v + pad_;
  }
  double slack() const { return 2 * pad_; }
  double reach() const { return reach_; }

  static constexpr Index k_cells = 160;
  static constexpr double k_far = 1e300;

 private:
  struct Edge {
    Vec2 begin, along;
    double end_y;           ///< as given: both edges of a corner agree on its side
    double inverse_square;  ///< of its length
  };
  std::vector<Edge> edges_;
  double reach_, per_unit_, pad_;
  std::vector<float> values_;  ///< at the corners of the cells, row by row
};

}  // namespace saddleback::distribution
