#pragma once
// All half-edges of a triangle list, those of one undirected edge side by side. Works for any list whose indices are in
// range, manifold or not: it is what decides.

#include <span>
#include <vector>

#include "saddleback/types.h"

namespace saddleback {

struct EdgeTable {
  std::vector<Index> halfedges;  ///< every half-edge once, by (smaller vertex, larger vertex, half-edge)
  std::vector<Index> begins;     ///< where each edge begins in `halfedges`; one more entry closes the last

  Index edge_count() const { return static_cast<Index>(begins.size()) - 1; }
  std::span<const Index> edge(Index e) const {
    return std::span(halfedges).subspan(begins[e], begins[e + 1] - begins[e]);
  }
};

/// A bucket per smaller vertex (counting sort), each sorted by itself: O(V + F) when valences are bounded.
EdgeTable build_edge_table(std::span<const Triangle> triangles, Index vertex_count);

/// Where half-edge 3f+i starts and ends.
inline Index halfedge_from(std::span<const Triangle> triangles, Index h) { return triangles[h / 3][h % 3]; }
inline Index halfedge_to(std::span<const Triangle> triangles, Index h) { return triangles[h / 3][(h % 3 + 1) % 3]; }

}  // namespace saddleback
