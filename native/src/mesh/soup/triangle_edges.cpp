#include <utility>

#include "saddleback/mesh/triangle_arrays.h"

#include "mesh/tables/corner_table.h"

namespace saddleback {
namespace {

/// Numbers edges as they come. They are chained at the end with fewer corners: the chains of a surface are short, also
/// where one vertex has very many neighbors ([chiba1985]: the sum over all edges of the smaller degree is linear in
/// their number).
class EdgeNumbers {
 public:
  EdgeNumbers(std::span<const Triangle> triangles, Index vertex_count)
      : corners_(vertex_count, 0), last_(vertex_count, k_none) {
    check_corners(triangles, vertex_count);
    for (const Triangle& t : triangles)
      for (const Index v : t) ++corners_[v];
    edges_.reserve(triangles.size() + triangles.size() / 2);
  }

  Index number(Index a, Index b) {
    if (corners_[b] < corners_[a] || (corners_[b] == corners_[a] && b < a)) std::swap(a, b);
    for (Index e = last_[a]; e != k_none; e = edges_[e].before)
      if (edges_[e].other == b) return e;
    edges_.push_back({a, b, last_[a]});
    return last_[a] = static_cast<Index>(edges_.size()) - 1;
  }

  Index count() const { return static_cast<Index>(edges_.size()); }
  std::array<Index, 2> ends(Index edge) const { return {edges_[edge].one, edges_[edge].other}; }

 private:
  struct Edge {
    Index one, other;
    Index before;  ///< in the chain of `one`
  };
  std::vector<Index> corners_, last_;
  std::vector<Edge> edges_;
};

}  // namespace

TriangleEdges triangle_edges(std::span<const Triangle> triangles, Index vertex_count) {
  EdgeNumbers edges(triangles, vertex_count);
  TriangleEdges result;
  result.corner_edges.reserve(3 * triangles.size());
  for (const Triangle& t : triangles)
    for (int i = 0; i < 3; ++i) result.corner_edges.push_back(edges.number(t[i], t[(i + 1) % 3]));
  result.ends.reserve(edges.count());
  for (Index edge = 0; edge < edges.count(); ++edge) result.ends.push_back(edges.ends(edge));
  return result;
}

}  // namespace saddleback
