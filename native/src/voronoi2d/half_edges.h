#pragma once
// The cells of all sites as one half-edge structure, numbered by the sites alone.

#include <cstdint>
#include <span>
#include <vector>

#include "saddleback/types.h"

#include "voronoi2d/planar_mesh.h"
#include "voronoi2d/site_order.h"

namespace saddleback::voronoi2d {

/// By rank of the site: the neighbours around it, counter-clockwise. An open cell's first and last neighbours are
/// those on the border; other lists begin with the lowest rank. Corner k of a cell lies after neighbour k.
struct Cells {
  std::vector<Index> offsets;         ///< (n + 1)
  std::vector<Index> neighbours;      ///< ranks
  std::vector<std::uint8_t> is_open;  ///< (n): the last corner is at infinity
  bool are_strips = false;            ///< all sites on one line: every corner is at infinity
  Index cell_count() const { return static_cast<Index>(is_open.size()); }
};

/// The cells of a triangulation of all sites (corners are ranks). Edges marked flat have no length: they are left out,
/// which makes one vertex of all triangles on one circle.
Cells cells_of(const PlanarMesh& mesh, std::span<const std::uint8_t> is_flat);

/// The cells of sites on one line: strips.
Cells strips_of(const OrderedSites& sites);

/// What the cells' corners and sides are called.
struct Numbering {
  std::vector<Index> corner_vertices;               ///< by corner: its vertex, k_none at infinity
  std::vector<Index> side_edges;                    ///< by neighbour: its edge
  std::vector<std::array<Index, 3>> vertex_sites;   ///< three sites (ranks) equally far from the vertex
  std::vector<std::array<Index, 2>> edge_vertices;  ///< k_none at infinity, which is never the first of two
  std::vector<std::array<Index, 2>> edge_sites;     ///< ranks: left and right of the edge
};

/// Numbers vertices by their lowest site, then counter-clockwise about it; edges likewise. O(corners).
Numbering number(const Cells& cells);

}  // namespace saddleback::voronoi2d
