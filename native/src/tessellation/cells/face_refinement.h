#pragma once
// Faces in halves and halves of halves, as fine as each place asks for.

#include <algorithm>
#include <array>
#include <vector>

#include "saddleback/mesh/mesh.h"
#include "saddleback/mesh/surface_points.h"

namespace saddleback {

/// A mesh whose faces are divided into triangles that fit along every edge. A part is halved across its longest edge,
/// parts beyond it as far as they must be for that [rivara1984], so that no part is much thinner than the face that it
/// comes from. Lengths are told by places in the face, which halving does not round: of thin faces, however often they
/// were halved, as well as of others.
class FaceRefinement {
 public:
  struct Part {
    Index face;                    ///< of the mesh
    std::array<Index, 3> corner;   ///< the mesh's vertices, then the added ones
    std::array<Vec3, 3> place;     ///< of the corners, barycentric in the face
    std::array<Index, 3> beyond;   ///< the part across the edge from corner i to i + 1, k_none at the boundary
    std::array<double, 3> length;  ///< of that edge
    double area;
  };

  /// Begins with one part a face. The mesh must outlive it.
  explicit FaceRefinement(const Mesh& mesh);

  const Mesh& mesh() const { return *mesh_; }
  const std::vector<Part>& parts() const { return parts_; }
  Index vertex_count() const { return mesh_->vertex_count() + static_cast<Index>(added_.size()); }
  /// The place of vertex V + i, in one face or in the two beside an edge, and the parts there that it was added to.
  struct Added {
    std::array<SurfacePoint, 2> at;
    std::array<Index, 2> part;
    int faces;
  };
  const std::vector<Added>& added() const { return added_; }

  /// Visits the parts about corner `i` of a part, but for itself.
  template <class Visit>
  void visit_about(Index part, int i, Visit&& visit) const;
  /// Halves a part and appends every part that changed, new ones too, to `changed`.
  void halve(Index part, std::vector<Index>& changed);

 private:
  int longest_edge(const Part& part) const;
  int edge_towards(Index part, Index other) const;
  Index cut(Index part, int edge, Index middle);

  const Mesh* mesh_;
  std::vector<Part> parts_;
  std::vector<Added> added_;
};

template <class Visit>
void FaceRefinement::visit_about(Index part, int i, Visit&& visit) const {
  const Index vertex = parts_[part].corner[i];
  const auto corner_of = [&](Index other) {
    return static_cast<int>(std::ranges::find(parts_[other].corner, vertex) - parts_[other].corner.begin());
  };
  // Across the edge that begins at the corner, and on; at the boundary the other way as well.
  Index other = parts_[part].beyond[i];
  for (; other != k_none && other != part; other = parts_[other].beyond[corner_of(other)]) visit(other);
  if (other == part) return;
  other = parts_[part].beyond[(i + 2) % 3];
  for (; other != k_none; other = parts_[other].beyond[(corner_of(other) + 2) % 3]) visit(other);
}

}  // namespace saddleback
