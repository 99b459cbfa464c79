#pragma once
// A graph's arcs found by the twin on a CUDA device.

#include <span>

#include "saddleback/cuda_twins.h"

#include "geodesics/graph_arcs.h"

namespace saddleback {

/// As unite_with_reverses(disk_arcs(...)), to the bit. \throw DeviceError when the device cannot do it; Cancelled.
ArcRows twin_arcs(const ArcSearch& search, const DiskRule& rule, std::span<const int> devices, DeviceTimes& times,
                  const JobStage& stage);

}  // namespace saddleback
