#pragma once
// Memory for results that a CUDA device writes by itself, at the full speed of its link.

#include "saddleback/job.h"
#include "saddleback/support/large_array.h"

namespace saddleback {

/// Gives what has been pinned and is at hand: of the wanted size, or up to a quarter more. Where nothing is, gives
/// memory of the usual kind. Pinning takes longer than the copy it serves, so that up to 2 GiB of what is freed stay at
/// hand, pinned, for arrays to come. Safe to use from any number of threads.
LargeMemory& pinned_memory();
/// Pins memory for the next array of so many bytes, unless there is some at hand, or more than a gigabyte is wanted, or
/// no CUDA module is loaded, or it pins no more. By `threads` (0: all cores). \throw Cancelled, std::bad_alloc
void make_pinned_room(std::size_t size, int threads, const JobStage& stage);
/// Gives back to the system what stays at hand.
void release_pinned_memory();

}  // namespace saddleback
