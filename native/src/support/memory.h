#pragma once
// How much memory can be had.

#include <cstddef>

namespace saddleback {

/// Bytes that the system could still give to this process; 0 when it does not say.
std::size_t available_memory();

}  // namespace saddleback
