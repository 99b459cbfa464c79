#include "charts/box_tree.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace saddleback::charts {

BoxTree::BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  if (order_.empty()) return;
  nodes_.resize(4 * std::bit_ceil(boxes_.size() / k_leaf + 1));
  build(1, 0, static_cast<Index>(order_.size()));
}

void BoxTree::build(std::size_t node, Index begin, Index end) {
  Box& whole = nodes_[node];
  whole = boxes_[order_[begin]];
  for (Index i = begin + 1; i < end; ++i) {
    whole.low = whole.low.cwiseMin(boxes_[order_[i]].low);
    whole.high = whole.high.cwiseMax(boxes_[order_[i]].high);
  }
  if (end - begin <= k_leaf) return;
  const int axis = whole.high.x() - whole.low.x() >= whole.high.y() - whole.low.y() ? 0 : 1;
  const Index middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](Index a, Index b) {
    const double at_a = boxes_[a].low[axis] + boxes_[a].high[axis], at_b = boxes_[b].low[axis] + boxes_[b].high[axis];
    return at_a < at_b || (at_a == at_b && a < b);
  });
  build(2 * node, begin, middle);
  build(2 * node + 1, middle, end);
}

}  // namespace saddleback::charts
