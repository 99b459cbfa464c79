#pragma once
// Images of cells: what every texel of a UV map shows, found on the surface itself.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "saddleback/support/large_array.h"
#include "saddleback/tessellation/geodesic_voronoi.h"

namespace saddleback {

/// Triangles of a UV map. A face may be seen by none or by several of them.
struct UvTriangles {
  std::span<const Index> faces;             ///< (n,) of the mesh
  std::span<const std::array<Vec2, 3>> uv;  ///< (n,) of the face's corners, in their order
  std::span<const double> values;           ///< (n, 3, channels) at these corners, linear between; or empty
  Index channels = 0;
};

struct BakeOptions {
  Index width = 1024, height = 1024;  ///< texels
  Index tile_u = 0, tile_v = 0;       ///< the image shows the UV square that begins there
  Index margin = 16;                  ///< texels as far from the triangles get what the nearest one within has
  bool edge_distance = true;
  bool local_uv = true;
  std::span<const Vec3> axes;  ///< (sites,) in space: where the first local axis points; empty: as `log_map` has it
  bool allow_overlaps = false;
  int threads = 0;  ///< 0: all cores; the result does not depend on it
};

/// Row 0 is the lowest; where no triangle is, nor is near, k_none and 0.
struct BakedCells {
  Index width = 0, height = 0, channels = 0;
  LargeArray<Index> triangle;       ///< (height, width) that holds the texel's center, without the margin
  LargeArray<Index> cell;           ///< (height, width)
  LargeArray<float> edge_distance;  ///< (height, width) to the boundary of the cell, infinity where it has none
  LargeArray<float> local_uv;       ///< (height, width, 2) the logarithm about the cell's site, mesh units
  LargeArray<float> values;         ///< (height, width, channels)
  std::vector<float> farthest;      ///< (cells,) the largest finite edge distance of the texels of each, or 0
  std::vector<Index> overlapping;   ///< triangles that share centers of texels with others, deeper than rounding
  std::vector<Index> without_area;  ///< triangles that are none in the UV map
  std::vector<Index> outside;       ///< triangles of which no part is in the image
};

/// Finds, for the center of every texel, its triangle and place, and from there on the surface: the cell, as its
/// outlines are; the geodesic distance to the boundary of the cell; the logarithm about its site; values linear over
/// triangles. Distances and logarithms are exact [chen1990] up to rounding to float. An edge of two triangles gives
/// every center to one of them.
/// \throw InputError for a size not in 1 to 16384, a margin not in 0 to 1024, faces off the mesh, UV places that are
/// not finite, arrays of other lengths; unless allowed, for triangles that overlap, with their number; of those the
/// first has the texel. Cancelled. O(texels (windows about a face + log(texels of a cell)) + windows); memory: the
/// arrays, 8 bytes a texel of 2^24 at a time, and some MB a thread.
BakedCells bake_cells(const SaddleVertexGraph& graph, const GeodesicVoronoi& cells, const UvTriangles& triangles,
                      const BakeOptions& options = {}, Job* job = nullptr);

}  // namespace saddleback
