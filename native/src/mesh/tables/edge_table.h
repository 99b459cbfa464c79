#pragma once
// All half-edges of a triangle list, those of one undirected edge side by side. Works for any list whose indices are in
// range, manifold or not: it is what decides.

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "saddleback/job.h"
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
/// \throw Cancelled
EdgeTable build_edge_table(std::span<const Triangle> triangles, Index vertex_count, const JobStage& stage = {});

/// The other half-edge of each one's edge; k_none where the edge has not two.
std::vector<Index> twins_of(const EdgeTable& edges);

/// Returns where half-edge 3f+i starts and ends.
inline Index halfedge_from(std::span<const Triangle> triangles, Index h) { return triangles[h / 3][h % 3]; }
inline Index halfedge_to(std::span<const Triangle> triangles, Index h) { return triangles[h / 3][(h % 3 + 1) % 3]; }

/// The corner of half-edge h's face that is not on h.
inline Index halfedge_apex(std::span<const Triangle> triangles, Index h) { return triangles[h / 3][(h % 3 + 2) % 3]; }

/// Calls visit(first, repeat) for each face that has the same three vertices as an earlier one, among those `around`
/// one edge. Equal faces meet in three edges and are reported only at the one between their two smaller vertices.
template <class Visit>
void for_each_duplicate(std::span<const Triangle> triangles, std::span<const Index> around, Visit&& visit) {
  const Index a = halfedge_from(triangles, around[0]), b = halfedge_to(triangles, around[0]);
  std::vector<std::pair<Index, Index>> apexes;  // (apex, face), in the order of faces
  if (around.size() == 2 && halfedge_apex(triangles, around[0]) != halfedge_apex(triangles, around[1])) return;
  for (const Index h : around)
    if (halfedge_apex(triangles, h) > std::max(a, b)) apexes.emplace_back(halfedge_apex(triangles, h), h / 3);
  std::sort(apexes.begin(), apexes.end());
  for (std::size_t i = 1, first = 0; i < apexes.size(); ++i) {
    if (apexes[i].first != apexes[first].first) {
      first = i;
    } else {
      visit(apexes[first].second, apexes[i].second);
    }
  }
}

}  // namespace saddleback
