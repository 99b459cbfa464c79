#pragma once
// Texels beside those that were drawn.

#include <functional>

#include "saddleback/job.h"
#include "saddleback/types.h"

namespace saddleback {

/// Calls `copy(to, from)` for each texel within `margin` of one with is_drawn(texel), which is the nearest; of equally
/// near ones the lower, then the one to the left. Texels are numbered by rows. \throw Cancelled. O(texels margin), less
/// where the nearest is near.
void fill_margin(Index width, Index height, Index margin, int threads, const std::function<bool(std::size_t)>& is_drawn,
                 const std::function<void(std::size_t, std::size_t)>& copy, const JobStage& stage);

}  // namespace saddleback
