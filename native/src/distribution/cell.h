#pragma once
// Cells of faces: triangles that halve their sides with each level.

#include <array>
#include <cstdint>

#include "saddleback/mesh/surface_points.h"

namespace saddleback::distribution {

/// Holds a square with sides of 1 / 2^level of the face's: corners (i, j), (i + 1, j), (i, j + 1) in units of that, as
/// weights of the face's corners 1 and 2, or (i, j), (i - 1, j), (i, j - 1) when it stands on its head.
struct Cell {
  Index face;
  std::int32_t i = 0, j = 0;
  std::uint8_t level = 0;
  bool is_inverted = false;

  double unit() const { return 1.0 / (1 << level); }
  Vec2 weights(double along, double up) const {
    const double sign = is_inverted ? -1 : 1;
    return Vec2(i + sign * along, j + sign * up) * unit();
  }
  Vec2 center() const { return weights(1.0 / 3, 1.0 / 3); }

  std::array<Cell, 4> children() const {
    const auto next = static_cast<std::uint8_t>(level + 1);
    const std::int32_t one = is_inverted ? -1 : 1;
    return {Cell{face, 2 * i, 2 * j, next, is_inverted}, Cell{face, 2 * i + one, 2 * j, next, is_inverted},
            Cell{face, 2 * i, 2 * j + one, next, is_inverted},
            Cell{face, 2 * i + one, 2 * j + one, next, !is_inverted}};
  }

  /// A number for each cell of the surface, to draw random numbers by.
  std::uint64_t key() const {
    const auto corner = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)) << 20) ^
                        static_cast<std::uint64_t>(static_cast<std::uint32_t>(j));
    return (static_cast<std::uint64_t>(face) << 32) ^ (corner << 6) ^ (static_cast<std::uint64_t>(level) << 1) ^
           (is_inverted ? 1u : 0u);
  }
};

inline constexpr int k_most_levels = 24;

inline SurfacePoint point_at(Index face, const Vec2& weights) {
  return {face, normalized_barycentric({1 - weights.x() - weights.y(), weights.x(), weights.y()})};
}

}  // namespace saddleback::distribution
