#pragma once
// Power diagrams of the plane.

#include <span>

#include "saddleback/job.h"
#include "saddleback/types.h"
#include "saddleback/voronoi2d/voronoi_2d.h"

namespace saddleback {

/// Power diagram (Laguerre's): a point x belongs to the site with the least |x - p|^2 - w, its power in the circle
/// about p with radius sqrt(w); weights may be negative, only their differences matter. Cells are convex with straight
/// edges, at right angles to the line through their sites; a site need not lie in its cell. `hidden` lists those that
/// have none, or one without an area. The result keeps the weights as `powers`. Exact as `voronoi_2d`
/// [aurenhammer1987]. \throw InputError as voronoi_2d, for a wrong number of weights, one that is not finite, and
/// weights so different in size from the coordinates' squares that products are not exact. Cancelled. O(n log n) time
/// expected, on one thread; O(n) memory.
Voronoi2d power_diagram_2d(std::span<const Vec2> sites, std::span<const double> weights, int threads = 0,
                           Job* job = nullptr);
/// Does the same as a part of other work.
Voronoi2d power_diagram_2d(std::span<const Vec2> sites, std::span<const double> weights, int threads,
                           const JobStage& stage);

}  // namespace saddleback
