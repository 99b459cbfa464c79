#pragma once
// Voronoi diagrams of the plane on a CUDA device.

#include "voronoi2d/cuda/diagram_abi.h"

namespace saddleback {

/// Finds the same diagram as the processor's, to the bit; `left` where it takes the processor. Never throws; `reason`
/// says why it failed.
CudaStatus find_voronoi_on_device(const DiagramRequest& request, const DiagramCaller& caller, DeviceTimes& times,
                                  CudaReason& reason);
/// Frees what stayed on a device.
void drop_voronoi_on_device(KeptPlane* kept);
CudaStatus copy_back_from_device(int device, const void* from, void* to, std::uint64_t bytes, CudaReason& reason);

}  // namespace saddleback
