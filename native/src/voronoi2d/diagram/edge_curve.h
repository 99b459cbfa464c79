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

/// The part of an edge that goes no farther than a length from the middle of its curve.
struct EdgePart {
  struct End {
    double t;     ///< parameter of the curve
    bool is_cut;  ///< short of its vertex, or of infinity
  };
  End from, to;
  /// True where all of the edge is farther out, on one arm of its curve.
  bool is_empty() const { return from.is_cut && to.is_cut && from.t == to.t; }
};
EdgePart edge_part(const Voronoi2d& diagram, Index edge, const Bisector& curve, double extent);

/// Appends an edge from first to second vertex as points no farther from it than a tolerance; an infinite end is as far
/// from the middle of the curve, or beyond the vertex, as `extent` says.
void add_edge_points(const Voronoi2d& diagram, Index edge, double tolerance, double extent, std::vector<Vec2>& points);

}  // namespace saddleback::voronoi2d
