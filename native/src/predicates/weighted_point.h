#pragma once
// A weighted site of the plane, for the processor and for devices.

namespace saddleback::predicates {

/// It is |x - p| - weight away from x.
struct WeightedPoint2 {
  double x, y, weight;
};

}  // namespace saddleback::predicates
