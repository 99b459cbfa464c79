#pragma once
// The order in which parts of a whole are done for those who watch: from all over it, since parts may take longer.

#include <numeric>

#include "saddleback/types.h"

namespace saddleback {

/// A step that leads through all of `count` parts, far from those before: the golden section of them, or near it.
inline Index scattering_step(Index count) {
  constexpr double k_golden = 0.618034;
  auto step = static_cast<Index>(count * k_golden);
  while (std::gcd(step, count) != 1) ++step;
  return step;
}

}  // namespace saddleback
