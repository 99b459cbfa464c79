#pragma once
// Everything that a triangle list must be before it may become a Mesh.

#include <span>

#include "saddleback/types.h"

#include "mesh/tables/edge_table.h"

namespace saddleback {

/// The checks that need no edges: sizes, index range, finite coordinates, repeated vertices, unreferenced vertices.
/// `coordinates` are so many a vertex. \throw MeshError with the first offenders.
void check_faces(std::span<const double> coordinates, int dimension, std::span<const Triangle> triangles);

/// \throw MeshError naming the first faces without area.
void check_areas(std::span<const Vec3> positions, std::span<const Triangle> triangles);

/// Does the same for three lengths a face, which must be finite, positive, of triangles, and equal on the two sides of
/// an edge but for rounding.
void check_lengths(std::span<const double> lengths, std::span<const Triangle> triangles, std::span<const Index> twins);

/// Duplicate faces, non-manifold edges, opposite orientations. \pre check_faces passed. \throw MeshError
void check_edges(std::span<const Triangle> triangles, const EdgeTable& edges);

}  // namespace saddleback
