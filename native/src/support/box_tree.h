#pragma once
// Which of many boxes, of the plane or of space, meet another box.

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>
#include <vector>

#include "saddleback/types.h"

namespace saddleback {

template <class Vector>
struct Box {
  Vector low, high;  ///< closed
  bool meets(const Box& other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
};

/// A bounding volume hierarchy: a complete binary tree of halves along the longest side.
template <class Vector>
class BoxTree {
 public:
  /// O(n log n).
  explicit BoxTree(std::vector<Box<Vector>> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    if (order_.empty()) return;
    nodes_.resize(4 * std::bit_ceil(boxes_.size() / k_leaf + 1));
    build(1, 0, static_cast<Index>(order_.size()));
  }

  const Box<Vector>& box(Index i) const { return boxes_[i]; }

  /// Calls visit(i) for every box i that meets `box`, in no particular order. O(log n + boxes met), typically.
  template <class Visit>
  void visit(const Box<Vector>& box, Visit&& visit) const {
    if (!order_.empty()) visit_node(1, 0, static_cast<Index>(order_.size()), box, visit);
  }

 private:
  static constexpr Index k_leaf = 4;  ///< boxes in a leaf, at most

  void build(std::size_t node, Index begin, Index end) {
    Box<Vector>& whole = nodes_[node];
    whole = boxes_[order_[begin]];
    for (Index i = begin + 1; i < end; ++i) {
      whole.low = whole.low.cwiseMin(boxes_[order_[i]].low);
      whole.high = whole.high.cwiseMax(boxes_[order_[i]].high);
    }
    if (end - begin <= k_leaf) return;
    int axis = 0;
    const Vector sides = whole.high - whole.low;
    for (int i = 1; i < sides.size(); ++i)
      if (sides[i] > sides[axis]) axis = i;
    const Index middle = begin + (end - begin) / 2;
    const auto twice_center = [&](Index i) { return boxes_[i].low[axis] + boxes_[i].high[axis]; };
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](Index a, Index b) {
      const double at_a = twice_center(a), at_b = twice_center(b);
      return at_a < at_b || (at_a == at_b && a < b);
    });
    build(2 * node, begin, middle);
    build(2 * node + 1, middle, end);
  }

  template <class Visit>
  void visit_node(std::size_t node, Index begin, Index end, const Box<Vector>& box, Visit& visit) const {
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

  std::vector<Box<Vector>> boxes_, nodes_;
  std::vector<Index> order_;
};

}  // namespace saddleback
