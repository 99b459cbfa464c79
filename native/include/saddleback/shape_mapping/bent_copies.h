#pragma once
// Meshes bent onto the surface, divided until they lie on it.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "saddleback/shape_mapping/map_shapes.h"

namespace saddleback {

/// A mesh in the space of a shape: x and y in its plane, z away from the surface, in the shape's units.
struct Solid {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
};

/// All copies one after the other. Vertices are fixed to the surface, so that they follow it when it moves.
struct BentCopies {
  SurfacePoints anchors;
  std::vector<double> heights;               ///< above the surface, mesh units
  std::vector<std::int64_t> begins;          ///< (n + 1) first vertex of each placement; the solid's own come first
  std::vector<Triangle> triangles;           ///< of mirrored copies they run the other way round: outside stays outside
  std::vector<Index> triangle_copy;          ///< which placement
  std::vector<Index> triangle_source;        ///< which triangle of the solid it is a part of
  std::vector<std::array<Vec3, 3>> weights;  ///< where a triangle's corners lie in its source, barycentric
  /// (n) by how much edges and faces may still leave the surface, as found at samples; shares of the copy's
  /// circumradius, not a number for what could not be laid.
  std::vector<double> deviations;
  std::vector<std::int64_t> lost;  ///< vertices beside the outline for which there is no surface: put at the center
};

struct BendOptions {
  MapShapesOptions mapping;
  /// Says how far edges and faces may leave the surface that their vertices lie on (or stand above), as a share of the
  /// copy's circumradius; 0: solids keep their vertices.
  double tolerance = 0.01;
  std::span<const Vec3> normals;  ///< (V,) the mesh's `vertex_normals`; empty: they are found
};

/// Bends the solid of each placement's shape onto the surface, as `conform` does. Between the vertices of a mesh that
/// is bent lie chords: where they leave the surface, edges are split where they leave it most, which is where they
/// cross an edge of the surface, and faces get vertices where it rises from them; neighbors agree about every edge.
/// \throw InputError for solids of another number than shapes, a vertex that is not finite, a triangle of corners that
/// are not there, a tolerance that is negative or not finite, and what map_shapes refuses; Cancelled. O(m log 1/t) a
/// copy besides the map, for m triangles.
BentCopies bent_copies(const Mesh& mesh, std::span<const Shape> shapes, std::span<const Placement> placements,
                       std::span<const Solid> solids, const BendOptions& options = {});

}  // namespace saddleback
