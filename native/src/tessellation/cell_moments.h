#pragma once
// Mass, centre and energy of cells.

#include <span>
#include <vector>

#include "tessellation/cell_complex.h"

namespace saddleback {

/// Integrals over a cell with weight density^2.
struct CellMoments {
  double mass = 0;
  Vec2 moment = Vec2::Zero();  ///< of the position in the site's tangent plane
  double energy = 0;           ///< of the squared distance to the site
};

/// Per cell. Polynomials of degree four on triangles are integrated exactly, which covers density^2 times squared
/// distance (both quadratic in a flat face). `density` (V,) or empty for 1. Sums run in face order: the same for any
/// thread count.
/// \throw Cancelled.
std::vector<CellMoments> cell_moments(const CellComplex& complex, std::span<const double> density, int threads,
                                      const JobStage& stage);

}  // namespace saddleback
