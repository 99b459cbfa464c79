#pragma once
// Even cells in the plane: centroidal Voronoi diagrams, stippling.

#include <span>
#include <string>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/types.h"
#include "saddleback/voronoi2d/planar_domain.h"

namespace saddleback {

/// Wanted cells per area, in proportion, over the bounding box of a domain: equal rectangles with one value each.
struct DensityRaster {
  std::span<const double> values;  ///< (rows * columns) row by row, the first at the least y; empty: uniform
  Index rows = 0, columns = 0;
};

struct Relaxation2dOptions {
  DensityRaster density;
  std::span<const double> weights;  ///< (n) of the additively weighted diagram, which stay; none: all alike
  int max_iterations = 100;
  double tolerance = 1e-6;  ///< stop when the energy falls by less than this share of itself; with weights when no site
                            ///< moves farther than this share of a mean cell's width
  int threads = 0;          ///< 0: all cores; the result does not depend on it
};

struct Relaxation2d {
  std::vector<Vec2> sites;
  std::vector<double> energy;  ///< of the start and after each iteration; never rises without weights
  int iterations = 0;
  bool converged = false;
  std::string stop_reason;
};

/// Moves sites to the centers of mass of their cells within a domain until they rest (Lloyd's method). A site whose
/// cell has no mass (outside, where the density is zero, equal to an earlier one) stays.
///
/// The energy is the integral of density^2 times squared distance to the nearest site: the square makes the number of
/// cells per area follow the density [du1999], so that dots at the sites have an image's tone [secord2002]. Integrals
/// over cells are exact: along their borders, row by row of the raster. \throw InputError for no sites, a coordinate
/// that is not finite, options out of range, a density that is negative, not finite or zero all over the domain;
/// Cancelled. Per iteration O(n log n + raster cells that borders of cells cross); O(rows * columns) memory.
///
/// With weights the cells are those of `voronoi_2d` with them, which are not the best for the energy: it is told, and
/// may rise by little; what falls is how far sites are from the centers, though not in every step. Hidden sites stay.
Relaxation2d relax_2d(std::span<const Vec2> sites, const PlanarDomain& domain, const Relaxation2dOptions& options = {},
                      Job* job = nullptr);

}  // namespace saddleback
