#pragma once
// The faces around each vertex, as one stretch of memory.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "saddleback/geodesics/saddle_vertex_graph.h"
#include "saddleback/support/large_array.h"

namespace saddleback {

/// Vertices are nodes of the graph here, and faces are in the order of their nodes: neighbors lie close in memory.
/// What walks over a mesh in any other order waits for memory most of its time. 300 bytes a vertex.
class VertexRings {
 public:
  /// A face at the vertex: its edge beyond.
  struct Wedge {
    Index from, to;             ///< the edge's ends, nodes
    Index side;                 ///< the edge in this face, 3 times the face and a number; the vertex is opposite
    bool from_bends, to_bends;  ///< the end has so much excess of angle that what lies behind it is not seen past it
    double length;
    Vec2 apex;  ///< the vertex in the frame of the side
  };
  /// Corners and sides are in the order of the mesh's.
  struct Face {
    std::array<Index, 3> nodes;  ///< of the corners
    std::array<Index, 3> twins;  ///< the sides beyond; k_none at the boundary
    Index in_mesh;
  };

  VertexRings(const SaddleVertexGraph& graph, int threads);
  /// Counter-clockwise.
  std::span<const Wedge> around(Index node) const {
    return {wedges_.data() + first_[node], wedges_.data() + first_[node + 1]};
  }
  /// Asks memory for the wedges around a node that is looked at soon.
  void fetch(Index node) const {
    constexpr std::size_t k_line = 64;
    const auto* const begin = reinterpret_cast<const std::byte*>(wedges_.data() + first_[node]);
    const auto* const end = reinterpret_cast<const std::byte*>(wedges_.data() + first_[node + 1]);
    for (const std::byte* line = begin; line < end; line += k_line) __builtin_prefetch(line);
  }
  /// Wedges are numbered node after node.
  const Wedge& wedge(Index index) const { return wedges_[index]; }
  Index index(const Wedge& wedge) const { return static_cast<Index>(&wedge - wedges_.data()); }
  Index face_count() const { return static_cast<Index>(faces_.size()); }
  const Face& face(Index face) const { return faces_[face]; }
  /// Returns the number that a face of the mesh has here.
  Index face_of(Index mesh_face) const { return places_[mesh_face]; }
  /// The half-edge of the mesh that a side is.
  Index halfedge(Index side) const { return 3 * faces_[side / 3].in_mesh + side % 3; }
  /// Tells whether paths that bend at the vertex spread from there.
  static bool bends_much(const Mesh& mesh, Index vertex);

 private:
  void order_faces(const SaddleVertexGraph& graph, int threads);

  LargeArray<Face> faces_;
  std::vector<Index> places_;  ///< of the mesh's faces
  LargeArray<Index> first_;
  LargeArray<Wedge> wedges_;
};

}  // namespace saddleback
