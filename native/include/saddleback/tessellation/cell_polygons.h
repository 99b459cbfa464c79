#pragma once
// Cells as polygons, one for each, and the quads between cells and their dual.

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "saddleback/mesh/barriers.h"
#include "saddleback/mesh/surface_curve.h"
#include "saddleback/tessellation/dual_mesh.h"

namespace saddleback {

struct CellPolygonOptions {
  DualPolicy policy = DualPolicy::repair;  ///< for cells that are no disks and so have no polygon
  /// Bounds how far a side leaves the boundary that it stands for, in parts of the size (root of the area) of the
  /// smaller of its cells; where it would be more, the polygon has corners on the way. Infinity: none but those needed.
  double bend = 0.15;
  double tolerance = std::numeric_limits<double>::infinity();  ///< and a length that it is never more than
  int threads = 0;                                             ///< of repair; the result does not depend on it
};

/// A polygon for each cell. Neighbors share their corners and sides: a closed surface gives a closed polygon mesh.
struct CellPolygons {
  SurfacePoints points;        ///< of the vertices
  std::vector<Vec3> vertices;  ///< where cells meet, where boundaries end at the mesh's, and where they bend
  std::vector<Index> corners;  ///< polygon i is [offsets[i], offsets[i + 1]) of them, counter-clockwise
  std::vector<Index> offsets;
  std::vector<Index> polygon_cell;  ///< ascending
  std::vector<Index> missing;       ///< cells with an area that are no disks and have no polygon: none after repair
  SurfacePoints sites;              ///< of the cells
  Index added = 0;                  ///< sites that repair added; they come last
  std::vector<std::uint8_t> is_barrier;  ///< by `corners`: whether the side from there on runs along a barrier
};

/// Polygons by the cells' corners. Two cells that meet along several boundaries, and cells with fewer than three
/// corners, get corners within those boundaries, so that no two sides join the same corners. Repair, as of the dual
/// mesh, is done only where a cell is no disk, or two fill a sphere. \throw InputError for a negative bend; where a
/// cell is no disk and the policy is to fail, or repair fails; Cancelled. O((V + F + boundaries) log F).
CellPolygons cell_polygons(const SaddleVertexGraph& graph, const GeodesicVoronoi& cells,
                           const CellPolygonOptions& options = {}, Job* job = nullptr);

/// Polygons of the whole surface by cells of one that barriers part. Sides run along barriers, straight pieces of them
/// each one side, and cells on both sides of a barrier share corners and sides there, so nothing is open. Where a
/// barrier ends within a cell, the cell's boundary is moved to its end, or it becomes two: cells after the last site.
/// There is no repair: `missing` tells. `split` becomes the whole mesh cut along the cells' boundaries. \throw
/// InputError as above; for cells that are not the barred mesh's.
CellPolygons cell_polygons(const Mesh& whole, const BarredMesh& barred, const GeodesicVoronoi& cells,
                           const CellPolygonOptions& options = {}, SplitMesh* split = nullptr);

/// Cuts the polygons into triangles between their corners, polygon i into offsets[i + 1] - offsets[i] - 2 in their
/// order: a fan where that has no turned triangle, else as Delaunay's as can be, seen along the polygon's mean normal.
/// O(n log n) for n corners as a rule.
std::vector<Triangle> polygon_triangles(const CellPolygons& polygons);

/// Quadrilaterals between sites, boundaries and branch points.
struct DualQuads {
  SurfacePoints points;  ///< the sites, then the middle of each edge of `dual_mesh`, then the branch points
  std::vector<Vec3> vertices;
  std::vector<std::array<Index, 4>> quads;  ///< branch point, middle, site, middle; counter-clockwise
};

/// The dual mesh with each triangle cut into three quads, as one step of Catmull-Clark cuts it, without smoothing: all
/// vertices lie on the surface. The middle of an edge is the point of the boundary between its cells that is nearest to
/// the edge, not too near to its ends; where the boundary crosses one of `curves`, on which both sites lie, it is that
/// crossing; of two sites on the mesh's boundary it is the end of the boundary between them. O(cells + boundaries).
DualQuads dual_quads(const Mesh& mesh, const GeodesicVoronoi& cells, std::span<const SurfaceCurve* const> curves = {});

}  // namespace saddleback
