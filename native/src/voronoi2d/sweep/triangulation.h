#pragma once
// The triangulation of sites, by one sweep circle or many.

#include <vector>

#include "saddleback/job.h"
#include "saddleback/support/large_array.h"

#include "voronoi2d/sites/site_order.h"

namespace saddleback::voronoi2d {

/// Delaunay's triangulation of some sites; of those on one circle it takes any. Half-edge 4 t + k goes from corner k of
/// triangle t to the next corner, counter-clockwise.
struct Triangulation {
  LargeArray<Index> corners;  ///< ranks; k_none where no triangle is; 4 t + 3 is free for use
  LargeArray<Index> twins;  ///< of half-edges, negative at the border; bit k of 4 t + 3: the triangle beyond half-edge
                            ///< 4 t + k shares its circle
  LargeArray<Index> leaving;  ///< by rank: a half-edge from there; at the border the one along it, counter-clockwise
  bool is_line = false;       ///< no triangles: all sites are on one line
};

/// Triangulates by circles over tiles of up to `tile_size` sites, then joined. Exact. O(n log n). \throw Cancelled
Triangulation triangulate(const OrderedSites& sites, Index tile_size, int threads, const JobStage& stage);

/// Each site's neighbors, counter-clockwise; on a line those before and after it.
struct NeighborLists {
  LargeArray<Index> offsets;    ///< (n + 1)
  LargeArray<Index> neighbors;  ///< ranks
};
NeighborLists neighbors_of(const Triangulation& triangulation, const OrderedSites& sites, const JobStage& stage);

}  // namespace saddleback::voronoi2d
