#pragma once
// The memory that is free.

#include <cstddef>

namespace saddleback {

/// Bytes that this process could still get, within the machine and the limits set for it (a container's, `ulimit -v`);
/// 0 when the system does not say.
std::size_t available_memory();

}  // namespace saddleback
