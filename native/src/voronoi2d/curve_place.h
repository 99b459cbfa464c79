#pragma once
// Places along Hilbert's curve of 2^16 x 2^16 squares, a bit of each axis at a time.

#include <cstdint>

#include "predicates/expansion.h"

namespace saddleback::voronoi2d {

inline constexpr int k_curve_bits = 16;

/// One halving of both axes: from bits of x and y to two bits of the place. State: 1 swaps the axes, 2 turns around.
SADDLEBACK_HOST_DEVICE constexpr std::uint32_t curve_step(std::uint32_t x, std::uint32_t y, std::uint32_t& state) {
  const std::uint32_t u = state & 2 ? 1 - x : x, v = state & 2 ? 1 - y : y;
  const std::uint32_t p = state & 1 ? v : u, q = state & 1 ? u : v;
  if (q == 0) state ^= p == 1 ? 3u : 1u;
  return 3 * p ^ q;
}

SADDLEBACK_HOST_DEVICE inline std::uint32_t place_by_bits(std::uint32_t x, std::uint32_t y) {
  std::uint32_t place = 0, state = 0;
  for (int bit = k_curve_bits - 1; bit >= 0; --bit)
    place = 4 * place + curve_step((x >> bit) & 1, (y >> bit) & 1, state);
  return place;
}

/// The square of a coordinate. Halves, since the width of the box may be beyond the doubles.
SADDLEBACK_HOST_DEVICE inline std::uint32_t square_of(double value, double low, double half_width) {
  constexpr double k_squares = 1 << k_curve_bits;
  const double share = (0.5 * value - 0.5 * low) / half_width * k_squares;
  return static_cast<std::uint32_t>(share < k_squares - 1 ? share : k_squares - 1);
}

}  // namespace saddleback::voronoi2d
