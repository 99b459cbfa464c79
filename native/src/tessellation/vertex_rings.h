#pragma once
// The faces around each vertex, as one stretch of memory.

#include <span>
#include <vector>

#include "saddleback/saddle_vertex_graph.h"

namespace saddleback {

/// Vertices are nodes of the graph here, in whose order neighbours lie close in memory: what walks over a mesh in any
/// other order waits for memory most of its time. 240 bytes a vertex.
class VertexRings {
 public:
  /// A face at the vertex: its edge beyond.
  struct Wedge {
    Index from, to;             ///< the edge's ends, nodes
    Index halfedge;             ///< the edge in this face
    bool from_bends, to_bends;  ///< the end has so much excess of angle that what lies behind it is not seen past it
    double length;
    Vec2 apex;  ///< the vertex in the frame of the half-edge
  };

  VertexRings(const SaddleVertexGraph& graph, int threads);
  /// Counter-clockwise.
  std::span<const Wedge> around(Index node) const {
    return {wedges_.data() + first_[node], wedges_.data() + first_[node + 1]};
  }
  /// Whether paths that bend at the vertex spread from there.
  static bool bends_much(const Mesh& mesh, Index vertex);

 private:
  std::vector<Index> first_;
  std::vector<Wedge> wedges_;
};

}  // namespace saddleback
