#pragma once
// The surface cut along outlines: faces that lie in one shape or in none.

#include "saddleback/job.h"
#include "saddleback/shape_mapping/map_shapes.h"

namespace saddleback {

/// A mesh whose vertices lie on another one.
struct CutMesh {
  SurfacePoints vertices;             ///< on the original mesh
  std::vector<Index> vertex_origin;   ///< vertex of the original mesh, k_none for those on outlines
  std::vector<Vec2> vertex_plane;     ///< in the plane of its shape, in its own units; (0, 0) outside of all
  std::vector<Triangle> triangles;    ///< oriented as the face that they are cut from
  std::vector<Index> triangle_face;   ///< of the original mesh
  std::vector<Index> triangle_shape;  ///< which of the mapped shapes, k_none outside of all
};

enum class CutPart : std::uint8_t {
  everything,  ///< the whole surface: its vertices first, in their order
  shapes,      ///< only what the shapes cover, each as a piece of surface of its own
};

/// Cuts the faces that outlines cross into triangles with the pieces of the outlines as edges, as near to Delaunay's as
/// those let them be. The shapes are those that could be mapped. \throw InputError naming two shapes that overlap,
/// unless they are cut out one by one; Cancelled when `job` (may be null) is stopped. O(F + m log m) for m pieces.
CutMesh cut_shapes(const Mesh& mesh, std::span<const MappedShape> shapes, CutPart part = CutPart::everything,
                   Job* job = nullptr);

}  // namespace saddleback
