#pragma once
// Memory for results that a CUDA device writes by itself, at the full speed of its link.

#include "saddleback/large_array.h"

namespace saddleback {

/// Pinned by the CUDA module, or of the usual kind where that is not loaded or no more can be pinned. Pinning takes
/// longer than the copy it serves, so that up to 2 GiB of what is freed stay at hand, pinned, for arrays to come: of
/// the block's size, or up to a fifth less. Safe to use from any number of threads.
LargeMemory& pinned_memory();
/// Gives back to the system what stays at hand.
void release_pinned_memory();

}  // namespace saddleback
