#pragma once
// Places that follow a density as evenly as places can.

#include <cstdint>
#include <span>

#include "saddleback/mesh/surface_points.h"

namespace saddleback::distribution {

/// `count` points, the number per area in proportion to the density (V,), each in the middle of a compact piece of the
/// surface that holds as much of it as any other's. Sheets that lie close to each other are told apart by their
/// normals. The same seed gives the same points. O(F log F + n log n) for n points.
SurfacePoints even_places(const Mesh& mesh, Index count, std::span<const double> density, std::uint64_t seed);

}  // namespace saddleback::distribution
