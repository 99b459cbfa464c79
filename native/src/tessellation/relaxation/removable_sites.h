#pragma once
// Sites that a dual mesh can do without.

#include <cstdint>
#include <span>
#include <vector>

#include "saddleback/tessellation/geodesic_voronoi.h"

#include "tessellation/cells/cell_moments.h"

namespace saddleback {

/// Up to `count` sites, no two of them with a neighbor in common, those that are missed least first. First of all such
/// as no three or four edges pass of the dual that close without triangles between them: there the dual goes round a
/// thin part. Then those that only four pass, whose vertices can be drawn into any of their neighbors' without a change
/// of the dual's topology (the link condition [dey1999]); then the others. Of equals those whose cells have the least
/// energy. Sites that are needed, (n,), are no candidates, nor are those with fewer than four neighbors. O(cells +
/// boundaries).
std::vector<Index> spare_sites(const GeodesicVoronoi& cells, std::span<const CellMoments> moments,
                               std::span<const std::uint8_t> is_needed, std::size_t count);

}  // namespace saddleback
