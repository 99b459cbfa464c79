#pragma once
// The triangulation of sites with powers.

#include <vector>

#include "saddleback/job.h"

#include "voronoi2d/sites/site_order.h"
#include "voronoi2d/sweep/triangulation.h"

namespace saddleback::voronoi2d {

/// The regular triangulation of `visible`: of the sites given those whose cells have an area, in their order. It
/// depends on the sites alone.
struct PowerTriangulation {
  OrderedSites visible;
  Triangulation triangulation;
};

/// Finds, of distinct sites with weights, which have a cell, and triangulates these: one site after the other, in
/// rounds of random ones, each along the curve [amenta2003], takes the place of the triangles at whose centers it has
/// the least power [edelsbrunner1996]. Exact. O(n log n) expected. \throw Cancelled
PowerTriangulation triangulate_by_powers(const OrderedSites& sites, const JobStage& stage);

}  // namespace saddleback::voronoi2d
