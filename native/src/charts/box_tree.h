#pragma once
// Which of many boxes of the plane meet another box.

#include <vector>

#include "saddleback/types.h"

namespace saddleback::charts {

struct Box {
  Vec2 low, high;  ///< closed
  bool meets(const Box& other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
};

/// A bounding volume hierarchy: a complete binary tree of halves along the longer side.
class BoxTree {
 public:
  /// O(n log n).
  explicit BoxTree(std::vector<Box> boxes);

  /// Calls visit(i) for every box i that meets `box`, in no particular order. O(log n + boxes met), typically.
  template <class Visit>
  void visit(const Box& box, Visit&& visit) const {
    if (!order_.empty()) visit_node(1, 0, static_cast<Index>(order_.size()), box, visit);
  }

 private:
  static constexpr Index k_leaf = 4;  ///< boxes in a leaf, at most

  void build(std::size_t node, Index begin, Index end);

  template <class Visit>
  void visit_node(std::size_t node, Index begin, Index end, const Box& box, Visit& visit) const {
    if (!nodes_[node].meets(box)) return;
    if (end - begin <= k_leaf) {
      for (Index i = begin; i < end; ++i)
        if (boxes_[order_[i]].meets(box)) visit(order_[i]);
      return;
    }
    const Index middle = begin + (end - begin) / 2;
    visit_node(2 * node, begin, middle, box, visit);
    visit_node(2 * node + 1, middle, end, box, visit);
  }

  std::vector<Box> boxes_, nodes_;
  std::vector<Index> order_;
};

}  // namespace saddleback::charts
