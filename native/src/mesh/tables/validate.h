#pragma once
// Everything that a triangle list must be before it may become a Mesh.

#include <span>

#include "saddleback/types.h"

#include "mesh/tables/edge_table.h"

namespace saddleback {

/// The checks that need no edges: sizes, index range, finite coordinates, repeated vertices, unreferenced vertices,
/// area. \throw MeshError with the first offenders.
void check_faces(std::span<const Vec3> positions, std::span<const Triangle> triangles);

/// Duplicate faces, non-manifold edges, opposite orientations. \pre check_faces passed. \throw MeshError
void check_edges(std::span<const Triangle> triangles, const EdgeTable& edges);

}  // namespace saddleback
