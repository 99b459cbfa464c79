// Where a window on the x axis is nearer than a source at p lies inside one branch of a hyperbola about the window's
// root (beyond a straight line when sigma is 0), which is convex. With u counted from the foot of the root and r(u) the
// length of the window's ray, it is nearer where |x - p|^2 >= (sigma + r)^2, that is where
//   g(u) = (|x - p|^2 - r^2 - sigma^2) - 2 sigma r,  in which the brackets are linear in u,
// is not negative. As g is concave, Newton's method from where it is negative comes near to its root without ever
// passing it: what is cut off is never too much, however few its steps are.

#include "geodesics/exact/window_trim.h"

#include <algorithm>
#include <cmath>

namespace saddleback {
namespace {

// The margin by which the source must win, relative to the distance, as in the propagation.
constexpr double k_slack = 1e-11;
constexpr int k_steps = 4;

/// The function g.
struct Lead {
  double dx, constant, sigma, height;

  double ray(double u) const { return std::sqrt(u * u + height * height); }
  double at(double u) const { return constant - 2 * dx * u - (sigma > 0 ? 2 * sigma * ray(u) : 0); }
  double slope(double u) const {
    const double r = ray(u);
    return -2 * dx - (r > 0 ? 2 * sigma * u / r : 0);
  }
};

/// Moves one end of an interval towards the other, at most to where the lead is no longer negative. \return false where
/// it is negative as far as the other end.
bool close_in(const Lead& lead, double& u, double other) {
  for (int step = 0; step < k_steps; ++step) {
    const double at = lead.at(u);
    if (at >= 0) return true;
    const double slope = lead.slope(u);
    if (!(at + slope * (other - u) > 0)) return false;
    u -= at / slope;
  }
  return true;
}

}  // namespace

void trim(Window& window, const Vec2& place) {
  const double dx = place.x() - window.sx, sigma = window.sigma;
  double begin = window.b0 - window.sx, end = window.b1 - window.sx;
  if (begin >= end) return;
  // Of the square of the longest way, or more.
  const double slack = 4 * k_slack * (sigma * sigma + window.sy * window.sy + std::max(begin * begin, end * end));
  const Lead lead{dx, dx * dx + (place.y() - window.sy) * (place.y() + window.sy) - sigma * sigma + slack, sigma,
                  window.sy};
  if (close_in(lead, begin, end) && close_in(lead, end, begin)) {
    window.b0 = std::max(window.b0, window.sx + begin);
    window.b1 = std::min(window.b1, window.sx + end);
  } else {
    window.b1 = window.b0;
  }
}

}  // namespace saddleback
