#pragma once
// A face laid flat by the lengths of its edges, on the processor and on a CUDA device alike.

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

}  // namespace saddleback
