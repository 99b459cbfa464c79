#pragma once
// Cells of given capacities in the plane: semi-discrete optimal transport, even stippling.

#include <span>
#include <string>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/types.h"
#include "saddleback/voronoi2d/planar_domain.h"
#include "saddleback/voronoi2d/relax_2d.h"

namespace saddleback {

struct Balance2dOptions {
  DensityRaster density;               ///< of the mass
  std::span<const double> capacities;  ///< (n) shares of the whole mass; none: all alike
  int max_iterations = 50;             ///< of the sites; 0 leaves them where they are
  double tolerance = 1e-4;             ///< stop when the energy falls by less than this share of itself
  double capacity_tolerance = 1e-5;    ///< how far a cell's mass may be from its capacity, in shares of that
  int threads = 0;                     ///< 0: all cores; the result does not depend on it
};

struct Balance2d {
  std::vector<Vec2> sites;
  std::vector<double> weights;  ///< (n) of the power diagram; their mean is 0
  std::vector<double> shares;   ///< (n) of the whole mass in each cell
  double capacity_error = 0;    ///< the largest of a cell's, in shares of its capacity
  std::vector<double> energy;   ///< with the capacities met: of the start and after each iteration; never rises
  int iterations = 0;
  bool converged = false;  ///< true if the sites rest and the capacities are met
  std::string stop_reason;
};

/// Moves sites to the centers of mass of their cells, and finds the weights with which the cells of the power diagram
/// [aurenhammer1987], within a domain, have given masses: whoever is at a place has the same to do as everybody else
/// [degoes2012]. For given sites the weights are those of optimal transport, by Newton's method with steps short enough
/// that no cell is lost [kitagawa2019].
///
/// The energy is the integral of density times squared distance to the site, of whose cell the place is. A site whose
/// cell has no mass (outside, where the density is zero, equal to another one) is put into a heavy cell first, or
/// refused if sites must stay. \throw InputError for no sites, a coordinate that is not finite, options out of range, a
/// density that is negative, not finite or zero all over the domain, capacities that are not positive or do not sum to
/// 1; Cancelled. Per step of Newton's method, some 4 to 10 at first and 2 for each iteration, O(n^1.5 + raster cells
/// that borders of cells cross); O(n log n + rows * columns) memory.
Balance2d balance_2d(std::span<const Vec2> sites, const PlanarDomain& domain, const Balance2dOptions& options = {},
                     Job* job = nullptr);

struct AreaWeightsOptions {
  DensityRaster density;          ///< of the mass that stands for area; none: area itself
  std::span<const double> areas;  ///< (n) in proportion; none: all alike
  double tolerance = 1e-4;        ///< how far a cell's share may be from the wanted one, in shares of that
  int max_iterations = 60;        ///< of Newton's method
  int threads = 0;                ///< 0: all cores; the result does not depend on it
};

struct AreaWeights {
  std::vector<double> weights;  ///< (n) of `voronoi_2d`; their mean is 0
  std::vector<double> shares;   ///< (n) of the domain's area, or mass, in each cell
  double error = 0;             ///< the largest of a cell's, in shares of the wanted one
  std::vector<double> lacks;    ///< what cells lack or have too much, in shares of the whole, as the root of the sum of
                                ///< squares: of equal weights and after each iteration; falls each time
  int iterations = 0;
  bool converged = false;  ///< true if the error is within the tolerance
  std::string stop_reason;
};

/// Finds the weights with which the cells of the additively weighted diagram, within a domain, have given areas: those
/// of optimal transport, whose cost is the distance. They are where a concave function, Kantorovich's, is largest; its
/// slope is what the cells lack, its second derivatives are integrals of 1 / |u - v| along the borders, u and v being
/// the directions to the two sites. Newton's steps are halved until no cell is lost and less is missing, as in
/// `balance_2d` [kitagawa2019]. \throw InputError for no sites, a coordinate that is not finite, options out of range,
/// a density that is negative, not finite or zero all over the domain, areas that are not positive, and for sites that
/// have no mass without weights; Cancelled. A step costs O(n^1.5 + raster cells that borders of cells cross).
AreaWeights weights_for_areas(std::span<const Vec2> sites, const PlanarDomain& domain,
                              const AreaWeightsOptions& options = {}, Job* job = nullptr);

}  // namespace saddleback
