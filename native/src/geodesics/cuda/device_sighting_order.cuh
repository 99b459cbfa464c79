#pragma once
// The order in which the processor sights what a source sees. A warp has its windows in another one, which keeps those
// of a generation together; rows are put into the processor's order when all have been found.
//
// The processor takes generation after generation, and of each first the windows behind left sides of their parents'
// faces, then those behind right ones, each in the order of the parents: of two windows the side that was taken last
// tells which is first, if that is the same the side before it, and in the end the half-edges of the source. The sides
// that a window has come through are its *turns*, a bit each, the last in the highest.

#include <cstdint>

#include "support/cuda/host_device.h"

namespace saddleback {
namespace {

/// A place in that order is 31 bits: the number of the source's half-edge, above it the turns. Before there are more
/// turns, windows get numbers in place of them; sources with more half-edges are left to the processor.
constexpr int k_root_edge_bits = 12, k_most_turns = 31 - k_root_edge_bits;

/// Tells which of a generation's sightings, all of one source, comes first: that with the lower number.
SADDLEBACK_HOST_DEVICE inline std::uint32_t order_in_generation(std::uint32_t turns, int root_edge) {
  return turns << k_root_edge_bits | static_cast<std::uint32_t>(root_edge);
}

/// Set in the first of a row that are of a generation.
constexpr std::uint32_t k_new_generation = std::uint32_t{1} << 31;

/// Returns where the `i`-th of `count` in a row comes in the processor's order; that of generations is theirs already.
__device__ inline int place_in_order(const std::uint32_t* order, int count, int i) {
  const auto rank_of = [&](int j) { return order[j] & ~k_new_generation; };
  const std::uint32_t own = rank_of(i);
  int place = i;
  for (int j = i; j > 0 && (order[j] & k_new_generation) == 0; --j) place -= own < rank_of(j - 1) ? 1 : 0;
  for (int j = i + 1; j < count && (order[j] & k_new_generation) == 0; ++j) place += rank_of(j) < own ? 1 : 0;
  return place;
}

}  // namespace
}  // namespace saddleback
