#pragma once
// Meshes from files.

#include <string>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh.h"

namespace saddleback {

/// What a file holds, unchecked: fit for `repair`.
struct MeshArrays {
  std::vector<double> xyz;       ///< three a vertex
  std::vector<Index> triangles;  ///< three a face; may be out of range where the file is wrong
};

/// Reads Wavefront OBJ, PLY (text and binary), OFF (text) or STL (text and binary), told apart by the extension.
/// Coordinates keep the file's precision. Polygons become triangles: a fan from the first corner from which none folds
/// over. An STL file names no vertices, so corners at exactly the same place become one.
/// \throw InputError when the file cannot be opened or its extension is unknown; MeshError, with the line or byte, when
/// its contents break off or make no sense, and when it has no faces. O(n), for STL O(n log n).
MeshArrays read_arrays(const std::string& path, Job* job = nullptr);

/// The same as a Mesh. \throw also MeshError when it is not a valid one; `repair(read_arrays(path))` then helps.
Mesh read_mesh(const std::string& path, Job* job = nullptr);

}  // namespace saddleback
