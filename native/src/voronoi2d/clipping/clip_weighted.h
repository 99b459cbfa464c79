#pragma once
// Cells with curved edges within a domain.

#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/voronoi2d/voronoi_2d.h"

#include "voronoi2d/clipping/domain_map.h"
#include "voronoi2d/clipping/loops.h"

namespace saddleback::voronoi2d {

/// Cells of weighted sites as polygons, their edges within a tolerance of the curves. Neighbors share their points, or
/// are a gap apart.
class CurvedCells {
 public:
  CurvedCells(const Voronoi2d& diagram, const PlanarDomain& domain, const DomainMap& map, double tolerance, double gap,
              const JobStage& stage);

  /// Returns what lies of a cell in the domain. O(points of the cell), times the corners of the domain if these are
  /// near; with a gap the points of each neighbor's curve times the points near it.
  /// \throw Cancelled
  std::vector<Loop> clip(Index site) const;

 private:
  double reach_from(Index site) const;
  Loop outline(Index site) const;
  std::vector<Loop> whole(Index site) const;
  void keep_distance(Index site, Index other, std::vector<Loop>& loops) const;
  void add_side(Index site, Index edge, Loop& loop) const;

  const Voronoi2d& diagram_;
  const DomainMap& map_;
  const JobStage& stage_;
  double tolerance_, distance_;           ///< of a cell's points from its curves
  Vec2 low_, high_;                       ///< the domain's box
  std::vector<Loop> loops_;               ///< the domain's, times the unit
  std::vector<PlanarDomain::Box> boxes_;  ///< of these
  double unit_ = 1;                       ///< a power of two, by which products of tiny coordinates are numbers
};

}  // namespace saddleback::voronoi2d
