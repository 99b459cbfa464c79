#pragma once
// Where a Voronoi vertex lies.

#include <cmath>

#include "saddleback/types.h"

#include "voronoi2d/circumcentre_point.h"

namespace saddleback::voronoi2d {

/// See `circumcentre_point`.
inline Vec2 circumcentre(const predicates::Point2& a, const predicates::Point2& b, const predicates::Point2& c) {
  const predicates::Point2 centre = circumcentre_point(a, b, c);
  return {centre.x, centre.y};
}

/// Two triangles side by side, so that vector units compute both at once: the numbers of `circumcentre_point`, but only
/// where `is_good`; elsewhere digits are lost.
struct TwoTriangles {
  double ax[2], ay[2], bx[2], by[2], cx[2], cy[2];  ///< corners
  double x[2], y[2];
  bool is_good[2];

  void set(int k, const predicates::Point2& a, const predicates::Point2& b, const predicates::Point2& c) {
    ax[k] = a.x, ay[k] = a.y, bx[k] = b.x, by[k] = b.y, cx[k] = c.x, cy[k] = c.y;
  }
  void find_centres() {
    double det[2], size[2];
    for (int k = 0; k < 2; ++k) {
      const double ux = bx[k] - ax[k], uy = by[k] - ay[k], vx = cx[k] - ax[k], vy = cy[k] - ay[k];
      const double left = ux * vy, right = uy * vx;
      det[k] = left - right;
      size[k] = std::fabs(left) + std::fabs(right);
      const double u2 = ux * ux + uy * uy, v2 = vx * vx + vy * vy;
      x[k] = ax[k] + 0.5 * ((vy * u2 - uy * v2) / det[k]);
      y[k] = ay[k] + 0.5 * ((ux * v2 - vx * u2) / det[k]);
    }
    for (int k = 0; k < 2; ++k) is_good[k] = !(std::fabs(det[k]) < k_cancelled_share * size[k]);
  }
  Vec2 centre(int k) const {
    if (is_good[k]) return {x[k], y[k]};
    return circumcentre({ax[k], ay[k]}, {bx[k], by[k]}, {cx[k], cy[k]});
  }

 private:
  static constexpr double k_cancelled_share = 0x1p-10;  ///< as in `circumcentre_point`
};

}  // namespace saddleback::voronoi2d
