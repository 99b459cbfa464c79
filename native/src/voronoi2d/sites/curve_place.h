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

/// Bits 0 to 15 to the even places.
SADDLEBACK_HOST_DEVICE constexpr std::uint32_t spread_bits(std::uint32_t bits) {
  bits = (bits | bits << 8) & 0x00ff00ffu;
  bits = (bits | bits << 4) & 0x0f0f0f0fu;
  bits = (bits | bits << 2) & 0x33333333u;
  return (bits | bits << 1) & 0x55555555u;
}

/// The place of a square: as by curve_step from the highest bits down, but of all bits at once. What a halving does to
/// the state (swap, turn) is affine over two elements: where x and y differ, (turn + c, swap + c), else (swap + turn +
/// c, turn), with c = 1 - y. So that states follow from a prefix sum of such maps, a word for each of their numbers.
SADDLEBACK_HOST_DEVICE constexpr std::uint32_t place_of_square(std::uint32_t x, std::uint32_t y) {
  const std::uint32_t differ = x ^ y;
  std::uint32_t swap_swap = ~differ, swap_turn = ~0u, turn_swap = differ, turn_turn = ~differ;
  std::uint32_t swap = ~y & 0xffffu, turn = swap & differ;  // of those before the first bit nothing is added
  for (int step = 1; step < k_curve_bits; step *= 2) {
    const std::uint32_t swap_before = swap >> step, turn_before = turn >> step;
    swap ^= (swap_swap & swap_before) ^ (swap_turn & turn_before);
    turn ^= (turn_swap & swap_before) ^ (turn_turn & turn_before);
    const std::uint32_t a = swap_swap >> step, b = swap_turn >> step, c = turn_swap >> step, d = turn_turn >> step;
    const std::uint32_t new_swap_swap = (swap_swap & a) ^ (swap_turn & c),
                        new_turn_swap = (turn_swap & a) ^ (turn_turn & c);
    swap_turn = (swap_swap & b) ^ (swap_turn & d);
    turn_turn = (turn_swap & b) ^ (turn_turn & d);
    swap_swap = new_swap_swap;
    turn_swap = new_turn_swap;
  }
  const std::uint32_t swapped = swap >> 1, turned = turn >> 1;  // before each bit
  const std::uint32_t high = (turned ^ (x ^ (swapped & differ))) & 0xffffu;
  return spread_bits(high) << 1 | spread_bits(differ);
}

/// The square of a coordinate. Halves, since the width of the box may be beyond the doubles.
SADDLEBACK_HOST_DEVICE inline std::uint32_t square_of(double value, double low, double half_width) {
  constexpr double k_squares = 1 << k_curve_bits;
  const double share = (0.5 * value - 0.5 * low) / half_width * k_squares;
  return static_cast<std::uint32_t>(share < k_squares - 1 ? share : k_squares - 1);
}

}  // namespace saddleback::voronoi2d
