#pragma once
// The cells of all sites as one half-edge structure, numbered by the sites alone.

#include <cstdint>
#include <span>
#include <vector>

#include "saddleback/large_array.h"
#include "saddleback/types.h"

#include "voronoi2d/planar_mesh.h"
#include "voronoi2d/site_order.h"

namespace saddleback::voronoi2d {

/// By rank of the site: the neighbours around it, counter-clockwise. An open cell's first and last neighbours are
/// those on the border; other lists begin with the lowest rank. Corner k of a cell lies after neighbour k.
struct Cells {
  LargeArray<Index> offsets;         ///< (n + 1)
  LargeArray<Index> neighbours;      ///< ranks
  LargeArray<std::uint8_t> is_open;  ///< (n): the last corner is at infinity
  bool are_strips = false;           ///< all sites on one line: every corner is at infinity
  Index cell_count() const { return static_cast<Index>(is_open.size()); }
};

/// The cells of sites on one line: strips.
Cells strips_of(const OrderedSites& sites);

/// The cells' corners and sides by number.
struct Numbering {
  LargeArray<Index> corner_vertices;               ///< by corner: its vertex, k_none at infinity
  LargeArray<Index> side_edges;                    ///< by neighbour: its edge
  LargeArray<Vec2> vertices;                       ///< in the given coordinates
  LargeArray<std::array<Index, 2>> edge_vertices;  ///< k_none at infinity, which is never the first of two
  LargeArray<std::array<Index, 2>> edge_sites;     ///< given indices: left and right of the edge
};

/// Numbers vertices by the lowest rank about them, then counter-clockwise about that site; edges likewise.
///
/// False when the cells do not fit together, because some were found from too few sites. Cells that do are right: every
/// edge passes the circle test among the neighbours of its cells; if each cell's neighbours wind around it once, if
/// neighbourhood is mutual, and if the number of vertices is Euler's, they are a triangulation of one plane (up to
/// vertices of more than three cells); and one that passes all circle tests is Delaunay's. All of this is exact.
/// O(corners).
bool number(const Cells& cells, const OrderedSites& sites, int threads, const JobStage& stage, Numbering& result);

}  // namespace saddleback::voronoi2d
