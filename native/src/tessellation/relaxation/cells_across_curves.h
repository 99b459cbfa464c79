#pragma once
// Cells that reach across a curve on which other sites are held.

#include <span>
#include <vector>

#include "saddleback/mesh/surface_curve.h"
#include "saddleback/tessellation/geodesic_voronoi.h"

namespace saddleback {

/// Puts free sites whose cells have a part of a curve onto it, in the middle of that part: of several curves onto the
/// one that the cell has most of. Else the triangulation dual to the cells would cut across the curve there. `fixed`
/// sites are left alone. \return whether there were any. O(length of the curves in cells).
bool hold_stray_sites(const Mesh& mesh, const GeodesicVoronoi& cells, std::span<const SurfaceCurve* const> curves,
                      std::span<const Index> fixed, SurfacePoints& sites, std::vector<Index>& held);

}  // namespace saddleback
