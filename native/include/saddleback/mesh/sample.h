#pragma once
// Points spread over a mesh in proportion to a density.

#include <cstdint>
#include <span>

#include "saddleback/job.h"
#include "saddleback/mesh/surface_points.h"

namespace saddleback {

struct SampleOptions {
  Index count = 1;
  /// (V,) wanted points per area, in proportion (only ratios matter), linear over each face; empty: the same
  /// everywhere.
  std::span<const double> density = {};
  std::uint64_t seed = 0;
  /// Every connected component gets at least one point (by area where its density is zero).
  bool one_per_component = false;
  Job* job = nullptr;
};

/// `count` surface points whose number per area follows the density, evenly enough to start a relaxation: the expected
/// number of points of any run of neighboring faces is met to within one, and points within one face keep apart.
/// The same seed gives the same points on every platform.
/// \throw InputError: count < 1, density of the wrong length, not finite, negative, or zero on the whole mesh;
/// one_per_component with fewer points than components; Cancelled. O(F log F + count).
SurfacePoints sample(const Mesh& mesh, const SampleOptions& options);
SurfacePoints sample(const Mesh& mesh, Index count, std::span<const double> density, std::uint64_t seed);

}  // namespace saddleback
