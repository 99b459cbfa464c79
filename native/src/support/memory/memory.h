#pragma once
// The memory that is free.

#include <cstddef>
#include <string>

namespace saddleback {

/// Bytes that this process could still get, within the machine and the limits set for it (a container's, `ulimit -v`);
/// 0 when the system does not say.
std::size_t available_memory();

/// Writes it for sentences: 12.3 GB.
std::string in_gigabytes(double bytes);

}  // namespace saddleback
