#pragma once
// What the library does with the memory of large arrays.

#include <cstddef>

namespace saddleback {

/// Copies `size` bytes by `threads` threads (0: all cores) where one takes long, above all to lay fresh pages.
void copy_large(void* to, const void* from, std::size_t size, int threads);

}  // namespace saddleback
