#pragma once
// A surface cut along the boundaries of cells, and along barriers that both sides then share: what polygons are made
// of.

#include <cstdint>
#include <vector>

#include "saddleback/mesh/barriers.h"
#include "saddleback/tessellation/geodesic_voronoi.h"

namespace saddleback {

struct PartedSurface {
  enum Line : std::uint8_t { none, barrier, drawn };
  SplitMesh split;
  SurfacePoints places;       ///< of its vertices after the mesh's own
  std::vector<Line> lines;    ///< by half-edge: beside the boundaries between cells and that of the mesh
  std::vector<double> areas;  ///< of the cells
};

PartedSurface parted_surface(const Mesh& mesh, const GeodesicVoronoi& cells);

/// Sews the cells of a barred mesh together along the barriers: a point on one side of a barrier is a vertex for the
/// other side, too. Then leads a boundary to every end of a barrier within a cell, which would be on both its sides:
/// by the shortest way along edges. What that cuts off goes to a neighbor, if it is little, or becomes a cell, numbered
/// after the others. \throw InputError for cells that are not the barred mesh's. O((V + F) log F), and O(F) for each
/// such end.
PartedSurface parted_surface(const Mesh& whole, const BarredMesh& barred, const GeodesicVoronoi& cells);

/// Twins of the half-edges; k_none on the boundary.
std::vector<Index> twins_of(const SplitMesh& split);

}  // namespace saddleback
