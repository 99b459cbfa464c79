#include "shapes/signed_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace saddleback::distribution {

SignedDistance::SignedDistance(const Shape& shape, double margin)
    : reach_(shape.circumradius() + margin), per_unit_(k_cells / (2 * reach_)) {
  for (const Shape::Loop& loop : shape.loops())
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec2 along = loop[(i + 1) % loop.size()] - loop[i];
      edges_.push_back({loop[i], along, loop[(i + 1) % loop.size()].y(), 1 / along.squaredNorm()});
    }
  // A distance changes by no more than the way. Interpolated between the corners of a cell it is off by at most the
  // mean way to them, which is longest in the middle: half a diagonal.
  pad_ = std::sqrt(0.5) / per_unit_ + 1e-6 * reach_;
  values_.resize(static_cast<std::size_t>(k_cells + 1) * (k_cells + 1));
  for (Index j = 0; j <= k_cells; ++j)
    for (Index i = 0; i <= k_cells; ++i)
      values_[static_cast<std::size_t>(j) * (k_cells + 1) + i] =
          static_cast<float>(exact({i / per_unit_ - reach_, j / per_unit_ - reach_}));
}

double SignedDistance::exact(const Vec2& point) const {
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (const Edge& edge : edges_) {
    const Vec2 arm = point - edge.begin;
    const double share = std::clamp(arm.dot(edge.along) * edge.inverse_square, 0.0, 1.0);
    nearest = std::min(nearest, (arm - share * edge.along).squaredNorm());
    const bool from_below = edge.begin.y() <= point.y(), to_below = edge.end_y <= point.y();
    if (from_below == to_below) continue;
    const double side = edge.along.x() * arm.y() - edge.along.y() * arm.x();
    if ((side > 0) == from_below) inside = !inside;
  }
  return inside ? -std::sqrt(nearest) : std::sqrt(nearest);
}

}  // namespace saddleback::distribution
