#pragma once
// The plane's diagram found by the CUDA module.

#include <optional>
#include <span>

#include "saddleback/voronoi2d/voronoi_2d.h"

namespace saddleback::voronoi2d {

/// Works as voronoi_2d, to the bit, by the options' CUDA devices; without weights where there are none. None where it
/// takes the processor: few or scattered sites, all on one line or one circle, numbers that are too large; of weighted
/// ones also where they share a place or doubles do not tell what exact numbers would. What lacks is `hidden` and the
/// weights. The sites may change meanwhile: then the diagram is of no use, but nothing breaks. \throw DeviceError when
/// the device cannot do it; Cancelled.
std::optional<Voronoi2d> cuda_voronoi(std::span<const Vec2> sites, std::span<const double> weights,
                                      const Voronoi2dOptions& options, const JobStage& stage);

}  // namespace saddleback::voronoi2d
