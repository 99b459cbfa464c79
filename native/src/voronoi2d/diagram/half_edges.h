#pragma once
// The cells of all sites as one half-edge structure, numbered by the sites alone.

#include "saddleback/job.h"
#include "saddleback/support/large_array.h"
#include "saddleback/types.h"

#include "voronoi2d/sites/site_order.h"
#include "voronoi2d/sweep/triangulation.h"

namespace saddleback::voronoi2d {

/// The cells' corners and sides by number. A cell's neighbors begin with the lowest rank; an open cell's first and
/// last neighbors are those on the border, and its last corner is at infinity. Corner k lies after neighbor k.
struct Numbering {
  LargeArray<Index> offsets;                       ///< by rank: where a cell's corners and sides begin; (n + 1)
  LargeArray<Index> corner_vertices;               ///< by corner: its vertex, k_none at infinity
  LargeArray<Index> side_edges;                    ///< by neighbor: its edge
  LargeArray<Vec2> vertices;                       ///< in the given coordinates
  LargeArray<std::array<Index, 2>> edge_vertices;  ///< k_none at infinity, which is never the first of two
  LargeArray<std::array<Index, 2>> edge_sites;     ///< given indices: left and right of the edge
};

/// Numbers vertices by the lowest rank about them, then counter-clockwise about that site; edges likewise. Triangles on
/// one circle become one vertex. Uses up the triangulation. O(corners). \throw Cancelled
Numbering number(Triangulation&& triangulation, const OrderedSites& sites, int threads, const JobStage& stage);

}  // namespace saddleback::voronoi2d
