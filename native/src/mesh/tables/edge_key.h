#pragma once
// One number for an edge of two vertices.

#include <algorithm>
#include <cstdint>

#include "saddleback/types.h"

namespace saddleback {

/// The same from both sides.
inline std::uint64_t edge_key(Index a, Index b) {
  return static_cast<std::uint64_t>(std::min(a, b)) << 32 | static_cast<std::uint32_t>(std::max(a, b));
}

}  // namespace saddleback
