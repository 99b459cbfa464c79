#pragma once
// The dual of geodesic Voronoi cells: the intrinsic Delaunay triangulation of the sites.

#include <memory>
#include <string>

#include "saddleback/mesh/trace.h"
#include "saddleback/tessellation/geodesic_voronoi.h"

namespace saddleback {

/// Says what to do where the cells are too large for a triangulation in the usual sense.
enum class DualPolicy {
  strict,  ///< keep the sites; corners of triangles and ends of edges may repeat; every violation is listed
  repair,  ///< add sites until there is no violation
  fail,    ///< refuse
};

/// Holds where cells break the closed-ball property [edelsbrunner1997], without which the dual is not a triangulation
/// of the surface.
struct DualIssue {
  enum class Kind {
    not_a_disk,         ///< a cell with a handle or several borders, or that is in several parts
    two_borders,        ///< a cell that meets the mesh's boundary in more than one arc
    closed_boundary,    ///< two cells meet along a closed curve: no triangle there
    double_boundary,    ///< two cells meet along several curves: a double edge
    cell_meets_itself,  ///< a cell is more than one of those around a branch point
    few_corners,        ///< a cell with fewer than three corners, ends at the mesh's boundary counted: no triangle
  };
  Kind kind;
  Index cell, other;   ///< `other`: k_none where one cell is concerned
  SurfacePoint place;  ///< where one more site mends it, or of a closed boundary one of three along it
};

std::string to_string(DualIssue::Kind kind);
/// A sentence that names the cells.
std::string to_string(const DualIssue& issue);

struct DualMesh {
  SurfacePoints sites;
  std::vector<Vec3> vertices;               ///< of the sites, on the surface
  std::vector<Triangle> triangles;          ///< one for each branch point, k - 2 where k cells meet; counter-clockwise
  std::vector<std::array<Index, 2>> edges;  ///< one for each open boundary between two cells
  std::vector<DualIssue> issues;            ///< of these sites: none after repair, unless it had to stop
  Index added = 0;                          ///< sites that repair added; they come last
  Index euler_characteristic = 0;           ///< sites with a cell - edges (and diagonals of fans) + triangles
  std::shared_ptr<const GeodesicVoronoi> repaired;  ///< the cells of these sites, where repair was asked for
};

/// The dual of given cells. O(cells + boundaries).
DualMesh dual_mesh(const Mesh& mesh, const GeodesicVoronoi& cells);

/// The dual by a policy. Repair puts a site where a violation is worst, lets the new sites find their middles (those on
/// the mesh's boundary stay), and looks again. \throw InputError when violations exist and the policy is to fail, or
/// when ten times as many sites and 1,000 more do not mend them (the mesh is too coarse for what lies between the
/// cells: subdivide it; or a strip is far narrower than the cells along it); Cancelled.
DualMesh dual_mesh(const SaddleVertexGraph& graph, const GeodesicVoronoi& cells, DualPolicy policy, int threads = 0,
                   Job* job = nullptr);

/// The edges of `dual_mesh(graph, cells)`, in its order, as paths on the surface: from the left cell's site to the
/// right one's, the locally shortest way in the class of the shortest one over the boundary between the two; of exact
/// cells by their own distances, of others by straightest geodesics or, where vertices are in their way, the graph's
/// shortest paths. \throw Cancelled. O(faces crossed) each, with a distance field for those by the graph.
std::vector<GeodesicPath> dual_edge_paths(const SaddleVertexGraph& graph, const GeodesicVoronoi& cells, int threads = 0,
                                          Job* job = nullptr);

}  // namespace saddleback
