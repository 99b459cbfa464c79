#pragma once
// Mass, center and energy of cells.

#include <array>
#include <span>
#include <vector>

#include "tessellation/cells/cell_candidates.h"

namespace saddleback {

/// Integrals over a cell with weight density^2.
struct CellMoments {
  double area = 0;  ///< without the weight
  double mass = 0;
  Vec2 moment = Vec2::Zero();  ///< of the position in the site's tangent plane
  double energy = 0;           ///< of the squared distance to the site
};

/// Integrates over cells with a density that does not change while sites move. Keeps its memory for other cells.
class CellIntegrals {
 public:
  /// `density` (V,) or empty for 1. Both must outlive it. O(F).
  CellIntegrals(const SaddleVertexGraph& graph, const VertexRings& rings, std::span<const double> density, int threads);

  /// Moments by cell. Integrals of density^2 times squared distance (both quadratic in a flat face) are exact. The same
  /// for any number of threads. `before`: those of the candidates before their last `find`, or none; cells that are
  /// as before keep theirs. \throw Cancelled. O(V + pieces), of the other cells.
  std::vector<CellMoments> moments(const CellCandidates& candidates, std::vector<CellMoments> before,
                                   const JobStage& stage);

  /// A flat face. Integrals over all of it: density^2 with the barycentric coordinates, and with what squared distances
  /// fall short of their corners' interpolation.
  struct Face {
    std::array<double, 3> squared_edges;  ///< of the side opposite each corner
    std::array<double, 3> weight;         ///< of each corner; their sum is the mass
    double bulge;
    double area;
  };

 private:
  /// The integrals about a node: a third of each face's.
  struct Node {
    double weight = 0, bulge = 0, area = 0;
  };
  void fetch_cell(const CellCandidates& candidates, Index site) const;
  CellMoments within(const CellCandidates& candidates, Index site) const;
  bool add_at_border(const CellCandidates& candidates, Index face, CellMoments& sum) const;
  static void add_about(const Node& about, const SiteVector& seen, CellMoments& sum);

  const VertexRings& rings_;
  const int threads_;
  LargeArray<Face> faces_;                      ///< in the rings' order
  std::vector<std::array<double, 3>> density_;  ///< of their corners; empty for 1
  LargeArray<Node> nodes_;
};

}  // namespace saddleback
