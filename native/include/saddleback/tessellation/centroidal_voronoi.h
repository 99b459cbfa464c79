#pragma once
// Centroidal Voronoi tessellation: even cells.

#include <cstdint>
#include <span>
#include <string>

#include "saddleback/mesh/surface_curve.h"
#include "saddleback/tessellation/cell_cache.h"
#include "saddleback/tessellation/dual_mesh.h"
#include "saddleback/tessellation/relaxation_watch.h"

namespace saddleback {

enum class RelaxationMethod { lbfgs, lloyd };

/// Says where a relaxation begins.
struct RelaxationStart {
  /// Says where sites come from when only their number is given: relaxed cells of a quarter of the number, with a site
  /// more on each boundary between two of them (few irregular cells remain; samples where coarse cells are no disks or
  /// meet twice), or a sample by density and seed. Automatic: from coarse cells for runs long enough to be worth it.
  /// Or from cells relaxed on a mesh of 20 vertices for each (10,000 at least), the cells of whose samples are found
  /// once: where the mesh has five times as many. Of max_iterations a tenth, 5 at least, are then made on the mesh
  /// itself; else as automatic.
  enum class From { automatic, coarse_to_fine, coarse_mesh, sample };
  From from = From::automatic;
  std::uint64_t seed = 0;  ///< of the sample
  /// Counts relaxations, only for a number of cells: so many relaxations, by the seeds from the given one on, of which
  /// the one with the least energy is the result. Where a relaxation ends depends on where it began.
  int starts = 1;
  /// Counts steps of simulated annealing before the iterations, each as long as one of those: ends with less energy
  /// than any number of iterations; 300 are many. Sites that would end with more energy are left as they were.
  int annealing = 0;
};

/// Says what sites may not do.
struct RelaxationConstraints {
  std::span<const Index> fixed;  ///< sites that stay where they are
  /// Curves that sites slide along instead of leaving them: features, the mesh's boundary.
  std::span<const SurfaceCurve* const> curves;
  /// (n,) the curve that each site is held on, k_none for free ones; empty: all are free. Held sites begin at the
  /// nearest points of their curves. Not for a number of cells, which says itself.
  std::span<const Index> held;
};

/// Says when a relaxation ends.
struct RelaxationStop {
  int max_iterations = 100;  ///< of each start
  double tolerance = 1e-6;   ///< stop when the energy falls by less than this share of itself
  /// Sites that an iteration would move by less, in roots of their cells' areas, stay where they are, and cells that
  /// neither move nor have neighbors that do are not found anew: where most sites rest, iterations are short. When
  /// all would stay, the run ends. 0: all move. 1e-3 is less than one sees; energies then end higher by about 1e-5.
  double least_move = 0;
  bool return_when_cancelled = false;  ///< the best found so far, instead of throwing
};

struct CentroidalVoronoiOptions {
  std::span<const double> density;  ///< (V,) wanted cells per area, in proportion; empty: uniform
  RelaxationMethod method = RelaxationMethod::lbfgs;
  RelaxationStart start;
  RelaxationConstraints constraints;
  RelaxationStop stop;
  /// Says whether sites are moved afterwards from where they are least needed to where the cells break the closed-ball
  /// property (see DualIssue), and all relaxed again as far as nothing breaks it: `count` sites then have a
  /// triangulation of the surface as their dual. Where no site can be spared, or 40 rounds of moving some do not help,
  /// or ten do not leave fewer faults, they are left as they were, and `issues` tells so.
  bool closed_ball = false;
  CellCache* cache = nullptr;  ///< cells to begin with, and afterwards those of the result
  /// Is shown the start and every iteration of the wanted number of sites; after an exchange for `closed_ball` from 0
  /// on again, and those at which the cells were looked at.
  RelaxationWatch* watch = nullptr;
  int threads = 0;       ///< 0: all cores; the result does not depend on it
  int cuda_device = -1;  ///< as in GeodesicVoronoiOptions, in every iteration
};

struct CentroidalVoronoi {
  SurfacePoints sites;
  std::vector<Index> held;  ///< (n,) the curve that each site is held on, k_none for free ones; empty: all are free
  GeodesicVoronoi cells;
  /// Holds the energies of the (annealed) start and after each iteration; never rises. After an exchange of sites those
  /// of the relaxation that followed, which may end above where the first one did; so `iterations`.
  std::vector<double> energy;
  int iterations = 0;
  bool converged = false;
  /// "tolerance", "no step lowers the energy", "least_move", "max_iterations", "cancelled"; "closed_ball" where
  /// no more steps kept the property
  std::string stop_reason;
  /// Energy without a scale, near 1 for many cells that are nearly regular hexagons: energy n / (2 G M^2) with
  /// G = 5 / (36 sqrt 3) and M the integral of the density. 1 is the least possible in a plane without a border.
  double normalized_energy = 0;
  Index exchanged = 0;            ///< sites that `closed_ball` moved to where they are needed more
  std::vector<DualIssue> issues;  ///< with `closed_ball`: where the cells break the closed-ball property all the same
};

/// A start for `count` cells: sampled by density and seed, at least one site on every component.
/// \throw InputError for count < 1 or fewer than components; for a density that `sample` refuses.
SurfacePoints initial_sites(const Mesh& mesh, Index count, std::span<const double> density, std::uint64_t seed);

/// Moves the sites until each rests at the center of its cell.
///
/// The energy is the integral of density^2 times squared distance to the nearest site: the square makes the number of
/// cells per area follow the density ([du1999]: cells of a CVT in the plane go with the square root of the weight).
/// Lloyd's step goes along the exponential map to the weighted mean of the cell in the site's tangent plane; L-BFGS
/// [liu2009] makes of several such steps a better one, on the product of the tangent planes. No step is accepted that
/// would raise the energy. A site that coincides with another, and so has no cell, is put where the most energy is.
/// Where it all ends depends on where it began: annealing (see the options; [kirkpatrick1983]) and several starts end
/// with less. \throw InputError for a density of wrong length, with a negative, infinite or not-a-number value, or zero
/// everywhere; for a fixed site out of range; for what geodesic_voronoi refuses; DeviceError; Cancelled unless the best
/// is to be returned. Per iteration O(sites k log k + arcs).
CentroidalVoronoi centroidal_voronoi(const SaddleVertexGraph& graph, const SurfacePoints& sites,
                                     const CentroidalVoronoiOptions& options = {}, Job* job = nullptr);

/// Does the same for a number of cells. Without iterations the sites are the sample's. With curves the first sites lie
/// on them, as far apart as neighbors are, the ends of open ones fixed; the others are the sample's, and those of them
/// whose cells reach across a curve are put onto it, before the relaxation that is reported. \throw InputError also as
/// `initial_sites`, and for fewer cells than the curves need.
CentroidalVoronoi centroidal_voronoi(const SaddleVertexGraph& graph, Index count,
                                     const CentroidalVoronoiOptions& options = {}, Job* job = nullptr);

}  // namespace saddleback
