#pragma once
// Makes a valid Mesh of nearly anything.

#include <map>
#include <span>
#include <string>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh/mesh.h"

namespace saddleback {

/// Borders that nearly meet in the mesh that came out: cracks that nobody sees and no path crosses.
struct CloseBorders {
  Index near_vertices = 0;        ///< border vertices nearer to another border's vertex than 1e-4 of an edge
  double weld_distance = 0;       ///< that would join all of these
  Index vertices_amid_edges = 0;  ///< border vertices as near to the inside of another border's edge: T-junctions

  /// Returns what would join them, each sentence after "; "; empty where there are none.
  std::string text() const;
};

/// Holds what a repair did. `changes` holds the kinds that happened, with their counts: faces_with_bad_index,
/// vertices_not_finite, vertices_unreferenced, vertices_welded, faces_repeating_a_vertex, faces_duplicate,
/// faces_without_area (mended or dropped), faces_dropped (of those and their neighbors, the ones that could not be
/// mended), edges_non_manifold, vertices_split (copies made), edges_divided (new vertex on the middle), edges_cut (of a
/// surface without orientation), faces_flipped, edges_stitched, holes_filled and holes_left (open, where filling was
/// asked for).
struct RepairReport {
  std::map<std::string, Index> changes;
  std::vector<Index> vertex_map;  ///< (old V,) new vertex, the first copy if it was split, or k_none
  std::vector<Index> face_map;    ///< (old F,) new face, the first part if it was divided, or k_none
  CloseBorders close_borders;

  /// Tells, for a person: "2 vertices welded, 1 duplicate face dropped" or "nothing to mend", and what would close
  /// cracks.
  std::string text() const;
};

struct RepairResult {
  Mesh mesh;
  RepairReport report;
};

struct RepairOptions {
  double weld_distance = 0;  ///< vertices within it become one; 0: those at the same place
  bool stitch = false;       ///< border edges are divided where border vertices lie on them, or within weld_distance
  Index fill_holes = 0;      ///< border loops of up to so many edges are filled; at most k_most_hole_edges
  Job* job = nullptr;
};
inline constexpr Index k_most_hole_edges = 2000;  ///< some seconds, and 50 MB

/// Drops what cannot be used (bad indices, non-finite vertices, repeated and duplicate faces, unreferenced vertices),
/// welds vertices at the same place or within `weld_distance`, splits non-manifold edges and vertices, orients the
/// faces (the outermost outward where closed, with what lies within, and where open so that decidedly more of the front
/// is seen from outside than of the back; a surface without orientation is cut along a seam) and mends faces without
/// area by collapsing their zero edge or flipping their long one. Borders that nearly meet are
/// told, or stitched; holes are filled where asked for. A good mesh without coincident vertices comes back as it was.
/// \throw MeshError when no face is left. \throw InputError for a negative or non-finite weld distance, a number of
/// edges out of range, coordinates or indices not in threes. O(n log n), and O(h^3) for a hole of h edges. The cutting
/// and stitching follows [gueziec2001], the filling [barequet1995].
RepairResult repair(std::span<const double> xyz, std::span<const Index> triangles, const RepairOptions& options = {});

}  // namespace saddleback
