#pragma once
// Sites that slide along curves.

#include <span>
#include <vector>

#include "saddleback/tessellation/centroidal_voronoi.h"

#include "tessellation/log_map/tangent_moves.h"

namespace saddleback {

/// The sites that are held on curves, and how they move there. A site's place on its curve is given by its arc length:
/// `along`, (n,), unused for sites that are free.
class HeldSites {
 public:
  /// No curves: all sites are free. The curves must outlive this object. \throw InputError for curves of another mesh,
  /// a wrong number of `held`, a curve that is not there.
  HeldSites(const Mesh& mesh, std::span<const SurfaceCurve* const> curves, std::span<const Index> held,
            std::size_t site_count);

  bool any() const { return !curve_of_.empty(); }
  bool is_held(std::size_t site) const { return any() && curve_of_[site] != k_none; }

  /// Brings the held sites to the nearest points of their curves. \throw Cancelled.
  std::vector<double> bring(SurfacePoints& sites, const JobStage& stage) const;
  /// Leaves of a field what points along the curves.
  void project(const std::vector<double>& along, const SurfacePoints& sites, TangentField& field) const;
  /// Moves the held sites along their curves instead of along geodesics: `moved` had them move like the others. Ends of
  /// open curves stop them.
  std::vector<double> move(const std::vector<double>& along, const SurfacePoints& sites, const TangentField& steps,
                           Moved& moved) const;

 private:
  struct Place {
    SurfacePoint point;
    double heading;  ///< of the curve in the tangent plane there, radians
  };
  Place place_at(const SurfaceCurve& curve, double along) const;

  const Mesh& mesh_;
  std::span<const SurfaceCurve* const> curves_;
  std::vector<Index> curve_of_;
};

/// A start for sites of which some are held.
struct HeldStart {
  SurfacePoints sites;  ///< those on curves first
  std::vector<Index> held, fixed;
};

/// Sites on the curves as far apart as neighbors in even cells of the density, the ends of open curves among them
/// (fixed; of ends less than half of that apart along curves one), then a sample of the rest. \throw InputError when
/// the curves alone need more than `count`; as initial_sites.
HeldStart held_start(const Mesh& mesh, Index count, std::span<const SurfaceCurve* const> curves,
                     std::span<const double> density, std::uint64_t seed, const JobStage& stage);

}  // namespace saddleback
