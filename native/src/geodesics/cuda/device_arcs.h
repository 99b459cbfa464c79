#pragma once
// Finding a graph's arcs on a CUDA device.

#include "geodesics/graph/arcs_abi.h"

namespace saddleback {

/// Finds every node's arcs and unites them with their reverses: the same words as the processor's, in the same order.
/// Never throws; `reason` says why it failed.
CudaStatus find_arcs_on_device(const ArcsRequest& request, const ArcsCaller& caller, DeviceTimes& times,
                               CudaReason& reason);

}  // namespace saddleback
