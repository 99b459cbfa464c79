#pragma once
// Weights of a face's corners, rounded so that sums and differences of them are exact.

#include <algorithm>
#include <cmath>

#include "saddleback/types.h"

namespace saddleback {

/// Weights are multiples of this, so that 1 - a - b has no rounding: then a point on an edge lies on it for the exact
/// predicates, too, and has the same weights in both faces.
inline constexpr double k_weight_step = 0x1p-50;
/// The least weight of a point that is not at a corner or on an edge: lengths of 1e-12 of a face do not matter, and
/// pieces of no length are ruled out.
inline constexpr double k_least_weight = 0x1p-40;

inline double rounded_weight(double weight, double most) {
  return std::round(std::clamp(weight, k_least_weight, most) / k_weight_step) * k_weight_step;
}

/// Returns the weight of the second end of an edge.
inline double edge_weight(double weight) { return rounded_weight(weight, 1 - k_least_weight); }

/// Returns the weights of corners 1 and 2, the point strictly inside.
inline Vec2 inner_weights(double first, double second) {
  const double a = rounded_weight(first, 1 - 2 * k_least_weight);
  return {a, rounded_weight(second, 1 - a - k_least_weight)};
}

/// The point of half-edge 3f+i with weight `t` of its end, as weights of the face's corners 1 and 2.
inline Vec2 on_edge(int i, double t) {
  if (i == 0) return {t, 0};
  if (i == 1) return {1 - t, t};
  return {0, 1 - t};
}

}  // namespace saddleback
