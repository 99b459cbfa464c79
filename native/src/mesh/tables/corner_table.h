#pragma once
// The corners of triangles about each vertex.

#include <algorithm>
#include <compare>
#include <span>
#include <utility>
#include <vector>

#include "saddleback/types.h"

namespace saddleback {

/// Serves any triangles, whichever way round.
class CornerTable {
 public:
  /// One corner of a triangle, at the vertex that it is asked for: the triangle's edge from there leads to `next`.
  struct Corner {
    Index triangle, next, previous;
  };

  /// \throw InputError naming the first triangle with a corner out of range. O(V + T).
  CornerTable(std::span<const Triangle> triangles, Index vertex_count);

  Index vertex_count() const { return static_cast<Index>(first_.size()) - 1; }
  /// Lists them by triangle.
  std::span<const Corner> at(Index vertex) const {
    return {corners_.data() + first_[vertex], corners_.data() + first_[vertex + 1]};
  }

 private:
  std::vector<Index> first_;
  std::vector<Corner> corners_;
};

/// Tells whether the edge from a vertex to `next` of one of its corners is one of another's triangle.
inline bool has_edge(const CornerTable::Corner& corner, const CornerTable::Corner& other) {
  return other.triangle != corner.triangle && (other.previous == corner.next || other.next == corner.next);
}

/// The corners at a vertex by the edges that they share: one by one where they are few, in order where they are many,
/// as at the hub of a wheel.
class SharedEdges {
 public:
  using Corner = CornerTable::Corner;
  explicit SharedEdges(std::span<const Corner> corners) : corners_(corners) {
    constexpr std::size_t k_few = 32;
    if (corners.size() <= k_few) return;
    for (Index i = 0; i < static_cast<Index>(corners.size()); ++i) {
      ends_.push_back({corners[i].next, i});
      ends_.push_back({corners[i].previous, i});
    }
    std::ranges::sort(ends_);
  }
  /// Tells whether one of the others with the edge to the corner's `next` is as wanted. They are asked by triangle.
  template <class IsWanted>
  bool any(const Corner& corner, IsWanted&& is_wanted) const {
    if (ends_.empty()) {
      return std::ranges::any_of(corners_,
                                 [&](const Corner& other) { return has_edge(corner, other) && is_wanted(other); });
    }
    Index last = k_none;
    for (auto end = std::ranges::lower_bound(ends_, End{corner.next, 0});
         end != ends_.end() && end->vertex == corner.next; ++end) {
      const Corner& other = corners_[end->corner];
      if (std::exchange(last, end->corner) == end->corner || other.triangle == corner.triangle) continue;
      if (is_wanted(other)) return true;
    }
    return false;
  }

 private:
  struct End {
    Index vertex, corner;
    auto operator<=>(const End&) const = default;
  };
  std::span<const Corner> corners_;
  std::vector<End> ends_;  ///< of the corners' edges; none where corners are few
};

/// \throw InputError naming the first triangle with a corner out of range.
void check_corners(std::span<const Triangle> triangles, Index vertex_count);

}  // namespace saddleback
