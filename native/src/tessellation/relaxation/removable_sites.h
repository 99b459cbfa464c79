#pragma once
// Sites that a dual mesh can do without.

#include <cstdint>
#include <span>
#include <vector>

#include "saddleback/tessellation/geodesic_voronoi.h"

#include "tessellation/cells/cell_moments.h"

namespace saddleback {

/// Returns up to `count` sites, no two of them with a neighbor in common, those that are missed least first. Sites come
/// first through which no closed loop of three or four dual edges leads without triangles between them (such loops go
/// around a thin part). Then come those on loops of four only, whose vertices can be drawn into any of their neighbors'
/// without a change of the dual's topology (the link condition [dey1999]); then the others. Among equals the cells of
/// least energy come first. Sites that are needed, (n,), are no candidates, nor are those with fewer than four
/// neighbors. O(cells + boundaries).
std::vector<Index> spare_sites(const GeodesicVoronoi& cells, std::span<const CellMoments> moments,
                               std::span<const std::uint8_t> is_needed, std::size_t count);

}  // namespace saddleback
