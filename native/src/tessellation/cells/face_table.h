#pragma once
// What cells are cut out of.

#include <span>

#include "saddleback/mesh/mesh.h"

namespace saddleback {

/// Faces and what is beside them: a mesh's own, or parts of them, which may be thinner than a mesh accepts. Whoever
/// made them must outlive the table.
struct FaceTable {
  static FaceTable of(const Mesh& mesh) {
    return {mesh.vertex_count(), mesh.triangles(), mesh.twins(), mesh.face_areas()};
  }
  Index face_count() const { return static_cast<Index>(triangles.size()); }
  Index halfedge_count() const { return 3 * face_count(); }

  Index vertex_count;
  std::span<const Triangle> triangles;
  std::span<const Index> twins;  ///< by half-edge, as Mesh has them
  std::span<const double> areas;
};

}  // namespace saddleback
