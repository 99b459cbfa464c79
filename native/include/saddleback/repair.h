#pragma once
// Makes a valid Mesh of nearly anything.

#include <map>
#include <span>
#include <string>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh.h"

namespace saddleback {

/// What a repair did. `changes` holds the kinds that happened, with their counts:
/// faces_with_bad_index, vertices_not_finite, vertices_unreferenced, vertices_welded, faces_repeating_a_vertex,
/// faces_duplicate, faces_without_area (mended or dropped), faces_dropped (of those and their neighbours, the ones that
/// could not be mended), edges_non_manifold, vertices_split (copies made), edges_divided (new vertex on the middle),
/// edges_cut (of a surface without orientation), faces_flipped.
struct RepairReport {
  std::map<std::string, Index> changes;
  std::vector<Index> vertex_map;  ///< (old V,) new vertex, the first copy if it was split, or k_none
  std::vector<Index> face_map;    ///< (old F,) new face, the first part if it was divided, or k_none

  /// One sentence for a person: "2 vertices welded, 1 duplicate face dropped" or "nothing to mend".
  std::string text() const;
};

struct RepairResult {
  Mesh mesh;
  RepairReport report;
};

/// Drops what cannot be used (bad indices, non-finite vertices, repeated and duplicate faces, unreferenced vertices),
/// welds vertices at the same place or within `weld_distance`, splits non-manifold edges and vertices, orients the
/// faces (outward where closed; a surface without orientation is cut along a seam) and mends faces without area by
/// collapsing their zero edge or flipping their long one. A good mesh without coincident vertices comes back as it was.
/// \throw MeshError when no face is left. \throw InputError for a negative or non-finite weld distance, coordinates or
/// indices not in threes. O(n log n). The cutting and stitching follows Gueziec, Taubin, Lazarus and Horn 2001.
RepairResult repair(std::span<const double> xyz, std::span<const Index> triangles, double weld_distance = 0,
                    Job* job = nullptr);

}  // namespace saddleback
