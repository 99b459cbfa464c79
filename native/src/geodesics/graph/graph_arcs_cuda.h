#pragma once
// A graph's arcs found by the CUDA module.

#include <functional>
#include <span>

#include "geodesics/graph/graph_arcs.h"
#include "support/cuda/cuda_module.h"

namespace saddleback {

/// Works as unite_with_reverses(disk_arcs(...)), to the bit. `choose_codec` is called while the mesh is copied to the
/// device, and the arcs come into memory of the kind that `room`, which is empty, takes.
/// \throw DeviceError when the device cannot do it; Cancelled.
ArcRows cuda_arcs(const ArcSearch& search, const std::function<ArcCodec()>& choose_codec, const DiskRule& rule,
                  std::span<const int> devices, ArcWords room, DeviceTimes& times, const JobStage& stage);

}  // namespace saddleback
