#pragma once
// How cells share the mesh's boundary.

#include <optional>
#include <vector>

#include "tessellation/cells/cell_topology.h"

namespace saddleback {

/// A stretch of a boundary loop that one cell has, or all of the loop.
struct BorderArc {
  Index cell = k_none;
  bool is_loop = false;
  double least = 0;           ///< distance from the site
  SurfacePoint nearest, far;  ///< to the site and from it; where no vertex lies within the arc, its middle
};

/// All arcs of all loops. O(V + boundaries).
std::vector<BorderArc> border_arcs(const Mesh& mesh, const GeodesicVoronoi& cells, const PointStars& stars);

/// Where one more site parts each cell from a part of the boundary, by cell: of a loop that it has whole, the point
/// farthest from its site; else, of the arcs but the nearest, the point nearest to it. None for cells with fewer arcs.
std::vector<std::optional<SurfacePoint>> places_on_borders(const Mesh& mesh, const GeodesicVoronoi& cells,
                                                           const PointStars& stars);

}  // namespace saddleback
