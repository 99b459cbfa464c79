#pragma once
// The part of a window that another source leaves.

#include "saddleback/types.h"

#include "geodesics/exact/exact_queue.h"

namespace saddleback {

/// Cuts off what the source at `place`, in a face on either side of the window's half-edge and in the frame of that, is
/// nearer to by more than rounding. Nothing is left where the window's end is not above its begin.
void trim(Window& window, const Vec2& place);

}  // namespace saddleback
