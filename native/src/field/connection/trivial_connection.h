#pragma once
// Connections whose only curvature lies where it is prescribed.

#include <memory>
#include <span>
#include <vector>

#include "saddleback/job.h"

#include "field/connection/dual_loops.h"
#include "field/linear/multigrid.h"

namespace saddleback {

/// Trivial connections in the Hodge form [crane2010]: the smallest turning, in the sense of the dual edges' weights,
/// with given indices. Its part from singularities is one Poisson problem over nodes; that from handles a combination
/// of harmonic forms, made when first needed and kept.
class TrivialConnection {
 public:
  /// The arguments must outlive this. O(F). \throw Cancelled.
  TrivialConnection(const Mesh& mesh, const SurfaceConnection& connection, const FilledSurface& filled,
                    const DualLoops& loops, const JobStage& stage);

  /// Returns for each half-edge the angle by which a field turns (besides the transport) from its face to the twin's;
  /// opposite for the twin. `units`: of each node of the filled surface the index times the symmetry; around handles
  /// the turning is the smallest that closes. `gentle`: loops of half-edges around which it shall not turn by more than
  /// k_told_share of pi / symmetry an edge, where whole turns around handles can prevent that. `given`: turning of each
  /// half-edge to which that around handles is near instead of being small; empty for none. \pre units sum to symmetry
  /// (2 - 2 genus) in each component. \throw Cancelled.
  std::vector<double> turns(std::span<const Index> units, int symmetry, std::span<const double> given,
                            const std::vector<std::vector<Index>>& gentle, const JobStage& stage);

  /// Returns how often a loop of half-edges goes round each of the loops around handles, in whole numbers; all 0 where
  /// it bounds a part of the surface, and the turning along it is nobody's choice. \pre turns() was called. O(loop
  /// handles).
  std::vector<double> windings_of(const std::vector<Index>& loop) const;

  /// Finds the same, but for units of the nodes in `free`: they may be any reals that sum to what is missing in the
  /// component. Gives those reals, the ones of least turning.
  std::vector<double> best_units(std::span<const Index> units, const std::vector<Index>& free, int symmetry,
                                 const JobStage& stage) const;

 private:
  std::vector<double> potential_turns(const std::vector<double>& potential) const;
  double harmonic(std::size_t loop, Index h) const;
  void find_harmonic_forms(const JobStage& stage);
  std::vector<double> harmonic_part(std::span<const double> given) const;
  void add_harmonic_part(std::vector<double>& turns, int symmetry, std::span<const double> given,
                         const std::vector<std::vector<Index>>& gentle) const;

  const Mesh& mesh_;
  const SurfaceConnection& connection_;
  const FilledSurface& filled_;
  const DualLoops& loops_;
  std::unique_ptr<MultigridSolver<double>> solver_;
  std::vector<std::vector<double>> harmonic_potentials_;  ///< per loop, over nodes
  std::vector<double> inverse_periods_;  ///< loops x loops; periods: what each form adds up to along each loop
};

}  // namespace saddleback
