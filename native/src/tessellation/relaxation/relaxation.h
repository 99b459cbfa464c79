#pragma once
// Sites that move towards the middles of their cells, step by step.

#include <vector>

#include "saddleback/job.h"
#include "saddleback/tessellation/centroidal_voronoi.h"

#include "tessellation/relaxation/cell_cache.h"
#include "tessellation/relaxation/lbfgs.h"
#include "tessellation/relaxation/sites_on_curves.h"

namespace saddleback {

/// Sites with what is needed to move on.
struct RelaxationState {
  SurfacePoints sites;
  std::vector<double> along;  ///< of held sites, see HeldSites
  std::vector<CellMoments> moments;
  double energy = 0;
};

/// The sites on their way. Graph and options must outlive it.
class Relaxation {
 public:
  Relaxation(const SaddleVertexGraph& graph, const SurfacePoints& sites, const CentroidalVoronoiOptions& options,
             const JobStage& stage);
  const SaddleVertexGraph& graph() const { return graph_; }
  const Mesh& mesh() const { return graph_.mesh(); }
  const RelaxationState& state() const { return state_; }
  /// Tells whether a site is neither fixed nor held on a curve.
  bool is_free(Index site) const { return !is_fixed_[site] && !held_.is_held(site); }
  /// Keeps these sites, (n,), where they are from now on, as fixed ones, until others are named.
  void rest(std::vector<std::uint8_t> sites);
  /// Cells of the state's sites: found again where others were looked at last. \throw Cancelled.
  const CellCandidates& cells(const JobStage& stage);
  /// Tells whether the last step that was refused would have moved no site by least_move.
  bool is_at_rest() const { return is_at_rest_; }
  /// Takes a step that lowers the energy; false when there is none. \throw Cancelled, the state as it was.
  bool advance(const JobStage& stage);
  /// Takes a step of Lloyd's that lowers the energy, whatever the method is.
  bool advance_to_centers(const JobStage& stage);

  /// Returns the move of each site to the center of its cell; none for fixed sites, along their curves for held ones.
  TangentField lloyd_direction() const;
  /// Goes along the steps whatever the energy does then: no site out of its cell, fixed ones not at all, held ones
  /// along their curves. Tells the steps as made. \throw Cancelled, the state as it was.
  TangentField go(TangentField steps, const JobStage& stage);
  /// Moves the sites to other places, held ones with `along`. \throw Cancelled, the state as it was.
  void go_to(SurfacePoints sites, std::vector<double> along, const JobStage& stage);

 private:
  RelaxationState evaluate(SurfacePoints sites, std::vector<double> along, const JobStage& stage);
  bool revive_empty_cells(const JobStage& stage);
  SurfacePoint far_place(const CellCandidates& cells, Index site) const;
  bool advance_by(TangentField direction, const TangentField& gradient, const JobStage& stage);
  TangentField gradient(const RelaxationState& state) const;
  TangentField quasi_newton_direction(const TangentField& gradient) const;
  void hold(const RelaxationState& state, TangentField& field) const;
  void shorten(TangentField& direction) const;
  void leave_at_rest(TangentField& direction);

  const SaddleVertexGraph& graph_;
  const CentroidalVoronoiOptions& options_;
  const BorrowedCells cells_;  ///< of the sites that were looked at last
  std::vector<std::uint8_t> is_fixed_, is_resting_;
  const HeldSites held_;
  RelaxationState state_;
  LbfgsMemory memory_;
  bool is_at_rest_ = false;
};

}  // namespace saddleback
