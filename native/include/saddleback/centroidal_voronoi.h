#pragma once
// Centroidal Voronoi tessellation: even cells.

#include <span>
#include <string>

#include "saddleback/geodesic_voronoi.h"

namespace saddleback {

struct CentroidalVoronoiOptions {
  std::span<const double> density;  ///< (V,) wanted cells per area, in proportion; empty: uniform
  int max_iterations = 100;
  double tolerance = 1e-6;  ///< stop when the energy falls by less than this share of itself
  int threads = 0;          ///< 0: all cores; the result does not depend on it
};

struct CentroidalVoronoi {
  SurfacePoints sites;
  GeodesicVoronoi cells;
  std::vector<double> energy;  ///< of the start and after each iteration; never rises
  int iterations = 0;
  bool converged = false;
  std::string stop_reason;
};

/// A start for `count` cells: sampled by density and seed, at least one site on every component.
/// \throw InputError for count < 1 or fewer than components; for a density that `sample` refuses.
SurfacePoints initial_sites(const Mesh& mesh, Index count, std::span<const double> density, std::uint64_t seed);

/// Moves the sites to the centres of their cells until they rest (Lloyd's method on the surface).
///
/// The energy is the integral of density^2 times squared distance to the nearest site: the square makes the number of
/// cells per area follow the density (Du, Faber, Gunzburger 1999: cells of a CVT in the plane go with the square root
/// of the weight). Each step goes along the exponential map to the weighted mean of the cell in the site's tangent
/// plane; a step that would raise the energy is shortened, and the best sites found are returned. \throw InputError for
/// a density of wrong length, with a negative, infinite or not-a-number value, or zero everywhere; for what
/// geodesic_voronoi refuses; Cancelled. Per iteration O(sites k log k + arcs).
CentroidalVoronoi centroidal_voronoi(const SaddleVertexGraph& graph, const SurfacePoints& sites,
                                     const CentroidalVoronoiOptions& options = {}, Job* job = nullptr);

}  // namespace saddleback
