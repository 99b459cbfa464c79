#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/types.h"

namespace saddleback {

/// The indices 0 to n-1 in ascending order of key, then of index. \throw Cancelled. O(n), unless many keys agree in
/// their first three dozen bits that differ at all.
std::vector<Index> order_of(std::span<const std::uint64_t> keys, int threads = 1, const JobStage& stage = {});

}  // namespace saddleback
