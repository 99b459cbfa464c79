#pragma once
// From sites to their cells, by one sweep circle or many.

#include "saddleback/job.h"

#include "voronoi2d/half_edges.h"
#include "voronoi2d/site_order.h"

namespace saddleback::voronoi2d {

/// All cells by one circle. O(n log n). \throw Cancelled
Cells find_cells(const OrderedSites& sites, const JobStage& stage);

/// All cells by many circles, about `circle_size` sites each. Cells near the border of what a circle saw may be wrong
/// even after they were found again among more sites: `number` notices. Without cells when so many are in doubt that
/// one circle is better. \throw Cancelled
Cells find_cells_by_tiles(const OrderedSites& sites, Index circle_size, int threads, const JobStage& stage);

}  // namespace saddleback::voronoi2d
