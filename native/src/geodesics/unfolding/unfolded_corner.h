#pragma once
// A face laid flat by the lengths of its edges, on the processor and on a CUDA device alike.

#include <cmath>

#include "support/cuda/host_device.h"

namespace saddleback {

/// Bounds lengths: beside edges so many times as long as they are themselves, waves of windows take others' places from
/// positions, which the processor has.
constexpr double k_extreme = 1 << 20;

/// Returns how far along an edge the far corner of its face is: `left` and `right` are the lengths of the sides at the
/// edge's start and end. Factored against cancellation on needles.
SADDLEBACK_HOST_DEVICE inline double corner_along(double base, double left, double right) {
  return (base + (left - right) * ((left + right) / base)) / 2;
}
/// Returns how far off it. From the area, which the mesh computes stably.
SADDLEBACK_HOST_DEVICE inline double corner_off(double base, double area) { return 2 * area / base; }

/// Tells whether a face is so much longer than it is high that single precision does not tell what is near across it
/// from what is not: (a, b) is its far corner where an edge is from (0, 0) to (1, 0).
SADDLEBACK_HOST_DEVICE inline bool is_too_thin(double a, double b) {
  constexpr double k_most = 1 << 19;
  const double left = a * a + b * b, right = (1 - a) * (1 - a) + b * b, longer = left > right ? left : right;
  return k_most * b <= (longer > 1 ? longer : 1.0);
}

/// Tells whether the far corner of the face behind a cone is on both of its rays as far as single precision tells, and
/// the cone is wide: waves would lose it. So is a source in a needle, or at the blunt end of one, beside another
/// needle.
SADDLEBACK_HOST_DEVICE inline bool is_on_both_rays(double right_x, double right_y, double left_x, double left_y,
                                                   double apex_x, double apex_y) {
  constexpr double k_on_both = 1e-4;  // sines: waves take 1e-6 for nothing, and round theirs
  const double from_right = (right_x * apex_y - right_y * apex_x) / std::sqrt(right_x * right_x + right_y * right_y);
  const double to_left = (apex_x * left_y - apex_y * left_x) / std::sqrt(left_x * left_x + left_y * left_y);
  const double most = k_on_both * std::sqrt(apex_x * apex_x + apex_y * apex_y);
  if (from_right > most || to_left > most) return false;
  return (apex_x * right_x + apex_y * right_y) * (apex_x * left_x + apex_y * left_y) < 0;
}

}  // namespace saddleback
