#pragma once
// Riemannian centers: the points from which squared geodesic distances are least in sum.

#include <span>

#include "saddleback/tessellation/geodesic_voronoi.h"

namespace saddleback {

/// The center of points of the surface, by logarithmic and exponential maps in turns until a step is shorter than 1e-9
/// of the points' spread: the sum of the weights times the squared distances has a minimum there, of several the one
/// that the given point nearest to the mean in space leads to, or where lengths were given the first one. A point
/// behind a saddle counts in the direction of the way to it; steps that do not lower the sum are made shorter, a
/// hundred at most, and may end beside the least where the sum has a crease, through a saddle vertex. After
/// [karcher1977]. \throw InputError for no points, points off the mesh or in several components, a wrong number of
/// weights, one that is negative or not finite, or all zero; Cancelled. A few log maps, O(n sqrt(n) log n) each for n
/// vertices within the spread.
SurfacePoint geodesic_center(const SaddleVertexGraph& graph, const SurfacePoints& points,
                             std::span<const double> weights = {}, Job* job = nullptr);

/// The center of each cell, by the integral of density^2 (as centroidal_voronoi has it); the site of a cell without
/// mass. Ways stay inside the faces that a cell touches. `density` (V,) or empty for 1. \throw InputError for a density
/// that centroidal_voronoi refuses; Cancelled. O(f log f) for f faces of a cell.
SurfacePoints cell_centers(const Mesh& mesh, const GeodesicVoronoi& cells, std::span<const double> density = {},
                           int threads = 0, Job* job = nullptr);

}  // namespace saddleback
