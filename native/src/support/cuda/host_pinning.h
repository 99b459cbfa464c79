#pragma once
// Host memory that CUDA devices copy to and from by themselves. Belongs to the CUDA part of the library.

#include <cstdint>

namespace saddleback {

/// Tells whether it is, for all devices, from here on.
bool pin_host_memory(void* memory, std::uint64_t bytes);
void unpin_host_memory(void* memory);

}  // namespace saddleback
