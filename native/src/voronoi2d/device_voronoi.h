#pragma once
// Voronoi diagrams of the plane on a CUDA device.

#include "voronoi2d/plane_twin.h"

namespace saddleback {

/// The same diagram as the processor's, to the bit; `left` where it takes the processor. Never throws; `reason` says
/// why it failed.
TwinStatus find_voronoi_on_device(const PlaneTwinRequest& request, const PlaneTwinCaller& caller, DeviceTimes& times,
                                  TwinReason& reason);

}  // namespace saddleback
