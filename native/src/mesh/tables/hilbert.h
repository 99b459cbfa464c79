#pragma once
// Order along a Hilbert curve: neighbors in the order are neighbors in space.

#include <Eigen/Geometry>
#include <cstdint>
#include <span>

#include "saddleback/types.h"

namespace saddleback {

/// Place of a point along a Hilbert curve through the box, 20 bits an axis. Points outside count as on the box.
class HilbertCurve {
 public:
  explicit HilbertCurve(std::span<const Vec3> points);
  std::uint64_t key(const Vec3& point) const;

 private:
  Vec3 lowest_ = Vec3::Zero();
  double scale_ = 0;  ///< cells per unit
};

}  // namespace saddleback
