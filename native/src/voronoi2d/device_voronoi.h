#pragma once
// Voronoi diagrams of the plane on a CUDA device.

#include "voronoi2d/plane_twin.h"

namespace saddleback {

/// The same diagram as the processor's, to the bit; `left` where it takes the processor. Never throws; `reason` says
/// why it failed.
TwinStatus find_voronoi_on_device(const PlaneTwinRequest& request, const PlaneTwinCaller& caller, DeviceTimes& times,
                                  TwinReason& reason);
/// Frees what stayed on a device.
void drop_voronoi_on_device(KeptPlane* kept);
TwinStatus copy_back_from_device(int device, const void* from, void* to, std::uint64_t bytes, TwinReason& reason);

}  // namespace saddleback
