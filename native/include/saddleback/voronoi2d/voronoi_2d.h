#pragma once
// Voronoi diagrams of the plane by sweep circles.

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/support/device_times.h"
#include "saddleback/support/large_array.h"
#include "saddleback/types.h"
#include "saddleback/voronoi2d/planar_domain.h"

namespace saddleback {

struct Voronoi2dOptions {
  Index circles =
      0;            ///< how many sweep circles share the work; 0: as many as are good. The result does not depend on it
  int threads = 0;  ///< 0: all cores. The result does not depend on it
  /// Numbers of CUDA devices that share the work, whose module must be loaded; none: the processor.
  /// The result does not depend on it.
  std::vector<int> cuda_devices = {};
  /// Says whether what CUDA devices find comes into pinned memory, which is kept: for one diagram after the other.
  bool is_pinned = false;
};

/// All cells in the order of their sites.
struct CellRows {
  std::vector<Index> offsets;   ///< (n + 1) the cell of site i is [offsets[i], offsets[i + 1])
  std::vector<Index> vertices;  ///< counter-clockwise; -1 where a cell is open
};

/// Holds what lies of each cell in a domain.
struct ClippedCells {
  std::vector<Vec2> points;         ///< (P) the corners of all loops, one after another
  std::vector<Index> loop_offsets;  ///< (L + 1) loop i is [offsets[i], offsets[i + 1])
  std::vector<Index> loop_sites;    ///< (L) ascending; outlines counter-clockwise, holes clockwise
  std::vector<double> areas;        ///< (n) 0 outside, and for sites equal to an earlier one
  std::vector<Vec2> centroids;      ///< (n) not a number where the area is 0
};

struct ClipOptions {
  double gap = 0;        ///< between neighbors: each cell keeps half of it from all others, but not from the domain's
                         ///< sides; parts of cells that are narrower vanish
  double tolerance = 0;  ///< of polylines along curved edges, the same for both cells, whose areas are those of the
                         ///< polygons; 0: a thousandth of a mean cell's width, of which it is 2^-28 at least
  int threads = 0;       ///< 0: all cores
};

/// A diagram with exact topology: which cells touch, and where more than three meet in one vertex, is decided without
/// any tolerance; only the vertices' coordinates are rounded. Numbering depends on the sites alone.
struct Voronoi2d {
  LargeArray<Vec2> sites;                       ///< (n) as given
  LargeArray<double> weights;                   ///< (n) as given, none if they are equal
  LargeArray<double> powers;                    ///< (n) weights of a power diagram as given, none of others
  LargeArray<Index> site_of;                    ///< (n) smallest index of an equal site: only such have a cell
  std::vector<Index> hidden;                    ///< ascending: sites that heavier ones leave no cell
  LargeArray<Vec2> vertices;                    ///< (V)
  LargeArray<std::array<Index, 2>> edges;       ///< (E) vertices; -1 at infinity: (v, -1) is a ray, (-1, -1) a line
  LargeArray<std::array<Index, 2>> edge_sites;  ///< (E) the sites left and right of the edge, first to second vertex

  std::optional<DeviceTimes> device_times;  ///< none when the processor found it

  // Cells in memory order; `cell_vertices` and `cell_edges` find a site's.
  LargeArray<Index> cell_sites;       ///< (C) site of each cell
  LargeArray<Index> cell_places;      ///< (n) cell of each site
  LargeArray<Index> cell_offsets;     ///< (C + 1)
  LargeArray<Index> corner_vertices;  ///< (2 E) by cell, counter-clockwise; -1 at infinity
  LargeArray<Index> side_edges;       ///< (2 E) by cell: the edge that ends at the corner

  /// Vertices around a site's cell, counter-clockwise; -1 stands where the cell is open. O(1).
  std::span<const Index> cell_vertices(Index site) const;
  /// The vertices of all cells, none for sites equal to an earlier one. O(E).
  CellRows cells() const;
  /// Edges around a site's cell: edge k leads to vertex k of `cell_vertices`. O(1).
  std::span<const Index> cell_edges(Index site) const;
  bool is_bounded(Index site) const;
  /// (E) unit vectors from first to second vertex; of a ray from its vertex outwards, where a curved one goes at last.
  /// O(E).
  std::vector<Vec2> edge_directions() const;
  /// Points along an edge from first to second vertex, two of a straight one. No point of the curve is farther from
  /// them and the chords between than a tolerance; one finer than 2^-40 of what the curve spans is taken as that. An
  /// infinite end is cut off `extent` farther from the middle of the curve than the edge's vertex, or than the middle
  /// where there is no vertex beyond it; 0: twice the distance of the sites. O(log of the length over the tolerance),
  /// and O(points). \throw InputError for a wrong index or lengths that are not positive.
  std::vector<Vec2> edge_polyline(Index edge, double tolerance, double extent = 0) const;
  /// (T) sites, counter-clockwise: the Delaunay triangulation. Where more than three sites lie on an empty circle, all
  /// triangles share the one with the smallest index. O(E).
  std::vector<Triangle> delaunay() const;
  /// (n) areas of the cells, infinite for open ones. Equal sites have the same cell. O(E).
  std::vector<double> areas() const;
  /// (n) centers of mass of the cells, not a number for open ones. O(E).
  std::vector<Vec2> centroids() const;
  /// The cells within a domain. O(n) plus, for cells at the domain's edges, O(corners of the domain). \throw Cancelled
  ClippedCells clip(const PlanarDomain& domain, int threads = 0, Job* job = nullptr) const;
  /// Does the same as a part of other work. \throw InputError for lengths that are negative or not finite.
  ClippedCells clip(const PlanarDomain& domain, const ClipOptions& options, const JobStage& stage) const;
  /// (m) nearest site of each point (of a power diagram the one with the least power there), exactly; of equally near
  /// ones the smallest index. Hidden sites are nowhere nearest. O(m + n) expected.
  /// \throw InputError for a point that is not finite, and without sites. Cancelled
  std::vector<Index> locate(std::span<const Vec2> points, int threads = 0, Job* job = nullptr) const;
  /// Sites of the cells that meet at a vertex, counter-clockwise, from the left of an edge that ends there.
  void sites_around(Index vertex, Index edge, std::vector<Index>& around) const;
};

/// Voronoi diagram of points of the plane, by sweep circles that grow from among the sites. Duplicates share a cell.
/// \throw InputError for a coordinate that is not finite; for coordinates so different in size (a factor of 1e100 and
/// more) that products of four are not exact; for negative options. Cancelled. O(n log n) time, O(n) memory.
Voronoi2d voronoi_2d(std::span<const Vec2> sites, const Voronoi2dOptions& options = {}, Job* job = nullptr);
/// Finds the same; the diagram takes the sites over.
Voronoi2d voronoi_2d(LargeArray<Vec2>&& sites, const Voronoi2dOptions& options = {}, Job* job = nullptr);
/// Does the same as a part of other work.
Voronoi2d voronoi_2d(std::span<const Vec2> sites, const Voronoi2dOptions& options, const JobStage& stage);

/// Additively weighted Voronoi diagram: of disks with the weights, which may be negative, as radii. A point belongs to
/// the site with the smallest |x - p| - w, so that only differences of weights matter. Edges are branches of
/// hyperbolas. A site is hidden when its disk lies in another's, touching it or not; then it has no cell. Two cells may
/// share several edges, a cell may have two vertices, one or none. \throw InputError as above, and for a weight that is
/// not finite or a wrong number of weights. Cancelled. O(n log n) time expected for evenly spread sites, O(n) memory.
Voronoi2d voronoi_2d(std::span<const Vec2> sites, std::span<const double> weights, const Voronoi2dOptions& options = {},
                     Job* job = nullptr);
/// Does the same as a part of other work.
Voronoi2d voronoi_2d(std::span<const Vec2> sites, std::span<const double> weights, const Voronoi2dOptions& options,
                     const JobStage& stage);

}  // namespace saddleback
