#pragma once
// The corners of triangles about each vertex.

#include <span>
#include <vector>

#include "saddleback/types.h"

namespace saddleback {

/// For any triangles, whichever way round.
class CornerTable {
 public:
  /// One corner of a triangle, at the vertex that it is asked for: the triangle's edge from there leads to `next`.
  struct Corner {
    Index triangle, next, previous;
  };

  /// \throw InputError naming the first triangle with a corner out of range. O(V + T).
  CornerTable(std::span<const Triangle> triangles, Index vertex_count);

  Index vertex_count() const { return static_cast<Index>(first_.size()) - 1; }
  /// By triangle.
  std::span<const Corner> at(Index vertex) const {
    return {corners_.data() + first_[vertex], corners_.data() + first_[vertex + 1]};
  }

 private:
  std::vector<Index> first_;
  std::vector<Corner> corners_;
};

/// Whether the edge from a vertex to `next` of one of its corners is one of another's triangle.
inline bool has_edge(const CornerTable::Corner& corner, const CornerTable::Corner& other) {
  return other.triangle != corner.triangle && (other.previous == corner.next || other.next == corner.next);
}

/// \throw InputError naming the first triangle with a corner out of range.
void check_corners(std::span<const Triangle> triangles, Index vertex_count);

}  // namespace saddleback
