#pragma once
// Triangulations of some sites as flat arrays, and the proof that one is Delaunay's.

#include <cstdint>
#include <span>
#include <vector>

#include "saddleback/types.h"

#include "predicates/predicates.h"

namespace saddleback::voronoi2d {

/// Half-edge 4 t + k goes from corner k of triangle t to the next corner, counter-clockwise; k = 3 is not used.
inline Index next_half(Index half) { return (half & 3) == 2 ? half - 2 : half + 1; }
inline Index previous_half(Index half) { return (half & 3) == 0 ? half + 2 : half - 1; }

/// A view: the arrays belong to others.
struct PlanarMesh {
  const double *x, *y;  ///< sites
  Index site_count;
  Index* triangles;  ///< corners
  Index* twins;      ///< k_none at the border
  Index triangle_count;

  predicates::Point2 point(Index site) const { return {x[site], y[site]}; }
  Index half_end() const { return 4 * triangle_count; }
};

/// Where the four sites about an edge between two triangles lie: `positive` when the triangles must be exchanged for
/// the other two, `zero` when they share a Voronoi vertex. Exact.
predicates::Sign circle_test(const PlanarMesh& mesh, Index half);

/// The edges, by one half each, that do not pass the circle test; marks those (both halves) whose triangles share a
/// Voronoi vertex. Exact.
std::vector<Index> fail_circle_tests(const PlanarMesh& mesh, std::span<std::uint8_t> is_flat);

/// Whether triangles that turn counter-clockwise and are joined by `twins` cover the convex hull of the sites once:
/// around an inner site they wind once, around a site of the border at most half a turn, the border is convex, and
/// there is one of it. Exact. If the edges pass the circle test as well it is Delaunay's triangulation.
bool is_triangulation(const PlanarMesh& mesh);

/// Exchanges the triangles beside an edge for the other two: p q r | q p s become p s r | s q r, where the half-edge
/// went from p to q.
void exchange_pair(PlanarMesh& mesh, Index half);

/// Makes a triangulation Delaunay's (C. L. Lawson, 1977): exchanges triangles until all edges pass the circle test.
/// `doubtful`: edges among which are all that do not.
void exchange_triangles(PlanarMesh& mesh, std::vector<Index> doubtful);

/// A triangulation of any distinct sites that are not all on one line, whatever the numbers: from the left, each site
/// is joined to the edges of the convex hull that it sees. For the rare ones that no sweep in doubles gets through.
/// `triangles` and `twins` have room for 2 n; sets `triangle_count`, 0 when all sites are on one line. O(n log n).
void triangulate_from_left(PlanarMesh& mesh);

}  // namespace saddleback::voronoi2d
