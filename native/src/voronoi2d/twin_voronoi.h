#pragma once
// The plane's diagram found by the twin on a CUDA device.

#include <optional>
#include <span>

#include "saddleback/voronoi_2d.h"

namespace saddleback::voronoi2d {

/// As voronoi_2d, to the bit, but for the sites, which the caller has; none where it takes the processor: few or
/// scattered sites, all on one line or one circle, numbers that are too large. \throw DeviceError when the device
/// cannot do it; Cancelled.
std::optional<Voronoi2d> twin_voronoi(std::span<const Vec2> sites, std::span<const int> devices, int threads,
                                      const JobStage& stage);
/// The same with a weight for each site; also none where sites share a place or doubles do not tell what exact numbers
/// would.
std::optional<Voronoi2d> twin_voronoi(std::span<const Vec2> sites, std::span<const double> weights,
                                      std::span<const int> devices, int threads, const JobStage& stage);

}  // namespace saddleback::voronoi2d
