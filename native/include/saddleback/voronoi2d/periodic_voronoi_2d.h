#pragma once
// Voronoi and power diagrams of a plane that repeats itself.

#include <array>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/types.h"
#include "saddleback/voronoi2d/voronoi_2d.h"

namespace saddleback {

/// Counts the periods by which something lies to the right and above.
using Shift = std::array<Index, 2>;

/// A diagram on a torus: on a box whose opposite sides are one. What belongs to a cell is told as seen from its site,
/// which lies in the box; a shift says by how many periods a vertex or another site lies elsewhere than in the box.
struct PeriodicVoronoi2d {
  Vec2 low, size;                                ///< the box, rounded as the sites are
  std::vector<Vec2> sites;                       ///< (n) in the box, low sides included, rounded to 2^-51 of its extent
  std::vector<double> powers;                    ///< (n) weights of a power diagram as given, none of others
  std::vector<Index> site_of;                    ///< (n) smallest index of an equal site: only such have a cell
  std::vector<Index> hidden;                     ///< ascending: sites that heavier ones leave no cell
  std::vector<Vec2> vertices;                    ///< (V) in the box
  std::vector<std::array<Index, 2>> edges;       ///< (E) vertices
  std::vector<Shift> edge_shifts;                ///< (E) of the second vertex, as seen from the first
  std::vector<std::array<Index, 2>> edge_sites;  ///< (E) the sites left and right of the edge; they may be the same
  std::vector<Shift> edge_site_shifts;           ///< (E) of the right one, as seen from the left
  std::vector<Index> cell_offsets;               ///< (n + 1) the corners and sides of site i are [offsets[i], ...)
  std::vector<Index> corner_vertices;            ///< (2 E) counter-clockwise
  std::vector<Shift> corner_shifts;              ///< (2 E) of these, as seen from the site
  std::vector<Index> side_edges;                 ///< (2 E) the edge that ends at the corner
  std::vector<Triangle> triangles;               ///< (T) sites: the Delaunay (or regular) triangulation of the torus
  std::vector<std::array<Shift, 3>> triangle_shifts;  ///< (T) of their corners, as seen from the first
  Voronoi2d around;                 ///< of the sites in the box, in their order, and of copies about it
  std::vector<Index> around_sites;  ///< (m) which site each of those is

  /// (2 E) the corners' places, as seen from the cells' sites. O(E).
  std::vector<Vec2> corner_places() const;
  /// (n) areas of the cells, which sum to the box's; 0 of hidden sites, equal sites have the same cell. O(E).
  std::vector<double> areas() const;
  /// (n) centers of mass as seen from the sites, perhaps beside the box; not a number for hidden sites. O(E).
  std::vector<Vec2> centroids() const;
  /// (m) the site of which a copy is nearest to each point, exactly for points in the box; others are brought there.
  /// Of equally near ones any. O(m + n) expected. \throw InputError for a point that is not finite. Cancelled
  std::vector<Index> locate(std::span<const Vec2> points, int threads = 0, Job* job = nullptr) const;
};

/// Diagram of sites and all their copies by whole periods in both directions. Sites are brought into the box and
/// rounded to 2^-51 of what the box and its neighbors span, so that copies are copies to the bit; of these the topology
/// is exact. Weights, if any, are those of a power diagram. \throw InputError as voronoi_2d and power_diagram_2d, for
/// no sites, and for a box without an area. Cancelled. O(n log n) time, O(n) memory.
PeriodicVoronoi2d periodic_voronoi_2d(std::span<const Vec2> sites, const Vec2& low, const Vec2& high,
                                      std::span<const double> weights = {}, int threads = 0, Job* job = nullptr);

}  // namespace saddleback
