#pragma once
// Cells as polygons, one for each, and the quads between cells and their dual.

#include <array>
#include <span>
#include <vector>

#include "saddleback/mesh/surface_curve.h"
#include "saddleback/tessellation/dual_mesh.h"

namespace saddleback {

struct CellPolygonOptions {
  DualPolicy policy = DualPolicy::repair;  ///< for cells that are no disks and so have no polygon
  /// Bounds how far a side leaves the boundary that it stands for, in parts of the size (root of the area) of the
  /// smaller of its cells; where it would be more, the polygon has corners on the way. Infinity: none but those needed.
  double bend = 0.15;
  int threads = 0;  ///< of repair; the result does not depend on it
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
};

/// Polygons by the cells' corners. Two cells that meet along several boundaries, and cells with fewer than three
/// corners, get corners within those boundaries, so that no two sides join the same corners. Repair, as of the dual
/// mesh, is done only where a cell is no disk, or two fill a sphere. \throw InputError for a negative bend; where a
/// cell is no disk and the policy is to fail, or repair fails; Cancelled. O((V + F + boundaries) log F).
CellPolygons cell_polygons(const SaddleVertexGraph& graph, const GeodesicVoronoi& cells,
                           const CellPolygonOptions& options = {}, Job* job = nullptr);

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
