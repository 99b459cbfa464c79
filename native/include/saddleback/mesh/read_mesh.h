#pragma once
// Meshes from files.

#include <string>
#include <string_view>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh/mesh.h"

namespace saddleback {

/// Holds what a file holds, its indices in range but else unchecked: fit for `repair`.
struct MeshArrays {
  std::vector<double> xyz;       ///< three a vertex
  std::vector<Index> triangles;  ///< three a face
  std::string warning;           ///< what was read but is hardly meant so: faces that cross themselves; usually empty
};

/// Reads Wavefront OBJ, PLY (text and binary), OFF (text) or STL (text and binary), told apart by the extension.
/// Coordinates keep the file's precision. Polygons become triangles that cover them, concave ones and such with holes
/// (edges there and back) too: a fan where one covers it, else Delaunay's triangulation, seen along the mean normal. An
/// STL file names no vertices, so corners at exactly the same place become one.
/// \throw InputError when the file cannot be opened or its extension is unknown; MeshError, with the line or byte, when
/// its contents break off or hold what is not understood, and when it has no faces. O(n), for STL and large concave
/// polygons O(n log n).
MeshArrays read_arrays(const std::string& path, Job* job = nullptr);
MeshArrays read_arrays(const std::string& path, const JobStage& stage);

/// Does the same of contents that are in memory; `path` tells the format, and is named in errors.
MeshArrays parse_arrays(const std::string& path, std::string_view contents, const JobStage& stage = {});

/// Reads the same as a Mesh. \throw also MeshError when it is not a valid one; `repair(read_arrays(path))` then helps.
Mesh read_mesh(const std::string& path, Job* job = nullptr);

}  // namespace saddleback
