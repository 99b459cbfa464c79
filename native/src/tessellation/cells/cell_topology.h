#pragma once
// Checks whether cells are disks that meet as they should.

#include <vector>

#include "saddleback/tessellation/dual_mesh.h"

namespace saddleback {

/// Polylines that leave each point of the diagram, and what lies beside them.
class PointStars {
 public:
  explicit PointStars(const GeodesicVoronoi& cells);
  struct Ray {
    Index polyline;
    bool forward;       ///< the polyline begins here
    Index left, right;  ///< cells beside it, seen along the way out
  };
  /// Rays of a branch point or of an end at the mesh's boundary.
  std::span<const Ray> rays(Index point) const {
    return {rays_.data() + first_[point], rays_.data() + first_[point + 1]};
  }

 private:
  std::vector<Index> first_;
  std::vector<Ray> rays_;
};

/// The cells around a branch point, counter-clockwise, one for each polyline that meets there.
std::vector<Index> cells_around(const PointStars& stars, Index branch_point);

/// Euler characteristic of every cell with its border, where it touches itself taken apart: 1 for a disk. O(V + F).
std::vector<Index> cell_characteristics(const Mesh& mesh, const GeodesicVoronoi& cells);

/// Every violation of the closed-ball property, by kind and cell. O(V + F).
std::vector<DualIssue> find_dual_issues(const Mesh& mesh, const GeodesicVoronoi& cells, const JobStage& stage = {});

/// The point of a polyline at a share of its length, 0 to 1. O(points).
SurfacePoint point_along(const Mesh& mesh, const GeodesicVoronoi& cells, Index polyline, double share);

/// A place for one more site.
struct PlaceToMend {
  SurfacePoint point;
  bool is_around;  ///< one of three around a thin part; they stay where they are, or would slip past each other
};

/// One place for each cell concerned: neighbors' complaints have often one cause. Where two cells meet along a closed
/// curve these are three, evenly along it, and come first: the cell of one alone would close around a thin part, too,
/// and toward the tip of a spike that would never end.
std::vector<PlaceToMend> places_to_mend(const Mesh& mesh, const GeodesicVoronoi& cells,
                                        const std::vector<DualIssue>& issues);

/// Tells whether a point lies on the mesh's boundary. A site that parts a cell from the boundary does so only there: in
/// the middle of its own cell it would meet both sides of a narrow strip again.
bool is_on_boundary(const Mesh& mesh, const SurfacePoint& place);

}  // namespace saddleback
