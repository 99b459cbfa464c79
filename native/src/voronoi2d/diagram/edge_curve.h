#pragma once
// Edges of a diagram as curves.

#include "saddleback/voronoi2d/voronoi_2d.h"

#include "voronoi2d/diagram/bisector.h"

namespace saddleback::voronoi2d {

/// The point between two sites of a diagram without curved edges where their bisector crosses the line through them;
/// of sites in either order the same, to the last bit.
Vec2 middle_between(const Voronoi2d& diagram, Index a, Index b);

/// A site with its weight, 0 in a diagram without.
WeightedPoint2 weighted_site(const Voronoi2d& diagram, Index site);

/// The curve of an edge, from its first to its second vertex.
Bisector edge_bisector(const Voronoi2d& diagram, Index edge);

/// The curve of one of a cell's edges, counter-clockwise about its site, in coordinates that count from the site.
Bisector bisector_beside(const Voronoi2d& diagram, Index site, Index edge);

/// Appends an edge from first to second vertex as points no farther from it than a tolerance; an infinite end is as far
/// from the middle of the curve, or beyond the vertex, as `extent` says.
void add_edge_points(const Voronoi2d& diagram, Index edge, double tolerance, double extent, std::vector<Vec2>& points);

}  // namespace saddleback::voronoi2d
