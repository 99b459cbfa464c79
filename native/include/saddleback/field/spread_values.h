#pragma once
// Values all over a surface from a few places where they are known.

#include <cstdint>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh/surface_points.h"

namespace saddleback {

enum class SpreadMethod : std::uint8_t {
  harmonic,    ///< as little slope as possible: cusps at the places, flat between; one linear system
  biharmonic,  ///< as little bending as possible: smooth through the places; two systems a place
};

struct SpreadOptions {
  SpreadMethod method = SpreadMethod::biharmonic;
  Job* job = nullptr;
};

/// (V,) values that meet `values` at `places` and never leave their range. Harmonic values hold at the corners of a
/// place's face; of places that share a vertex (biharmonic: that lie within a thousandth of the surface's size) a mean
/// is met, or nearly. Components without a place have the mean of all values.
/// \throw InputError for no place, one off the mesh, another number of values than places, a value that is not finite;
/// Cancelled. About O(V) a system.
std::vector<double> spread_values(const Mesh& mesh, const SurfacePoints& places, std::span<const double> values,
                                  const SpreadOptions& options = {});

}  // namespace saddleback
