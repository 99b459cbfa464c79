#pragma once
// The arcs in which cells share the mesh's boundary.

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

/// Returns for each cell where one more site would part it from a part of the boundary: on a loop that lies in it as a
/// whole, the point farthest from its site; otherwise the nearest point of its arcs other than the nearest arc. None
/// for cells with fewer arcs.
std::vector<std::optional<SurfacePoint>> places_on_borders(const Mesh& mesh, const GeodesicVoronoi& cells,
                                                           const PointStars& stars);

}  // namespace saddleback
