#pragma once
// Finding a graph's arcs on a CUDA device.

#include "geodesics/arc_twin.h"

namespace saddleback {

/// Finds every node's arcs and unites them with their reverses: the same words as the processor's, in the same order.
/// Never throws; `reason` says why it failed.
TwinStatus find_arcs_on_device(const ArcTwinRequest& request, const ArcTwinCaller& caller, DeviceTimes& times,
                               TwinReason& reason);

}  // namespace saddleback
