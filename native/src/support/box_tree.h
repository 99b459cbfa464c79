#pragma once
// Which of many boxes, of the plane or of space, meet another box.

#include <algorithm>
#include <bit>
#include <span>
#include <utility>
#include <vector>

#include "saddleback/job.h"
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
  BoxTree() = default;
  /// O(n log n). \throw Cancelled.
  explicit BoxTree(const std::vector<Box<Vector>>& boxes, const JobStage& stage = {})
      : boxes_(boxes.size()), order_(boxes.size()) {
    if (boxes.empty()) return;
    std::vector<Center> centers(boxes.size());
    for (Index i = 0; i < static_cast<Index>(boxes.size()); ++i) centers[i] = {boxes[i].low + boxes[i].high, i};
    nodes_.resize(4 * std::bit_ceil(boxes.size() / k_leaf + 1));
    build(1, centers, boxes, 0, stage);
  }

  /// Calls visit(i) for every box i that meets `box`, in no particular order. O(log n + boxes met), typically.
  template <class Visit>
  void visit(const Box<Vector>& box, Visit&& visit) const {
    if (!order_.empty()) visit_node(1, 0, static_cast<Index>(order_.size()), 0, box, visit);
  }

  /// Calls visit(i, j) for every box j that meets box i, the one at `place` in the tree's own order, and comes later in
  /// it: over all places, for each two boxes that meet once. Neighboring places look at nearly the same boxes.
  template <class Visit>
  void visit_later(Index place, Visit&& visit) const {
    const Index i = order_[place];
    visit_node(1, 0, static_cast<Index>(order_.size()), place + 1, boxes_[place], [&](Index j) { visit(i, j); });
  }

  /// Calls visit(i, j) for every box i of this tree and j of `other` that meet: both are gone down together, so that
  /// parts far from each other are left out at once.
  template <class Visit>
  void visit_both(const BoxTree& other, Visit&& visit) const {
    if (!order_.empty() && !other.order_.empty()) visit_parts(all(), other, other.all(), visit);
  }

  /// Calls visit(i) for every box i whose squared distance from a point is less than `most`, or hardly more, roughly
  /// the nearest first: the visit may lower `most`. O(log n + boxes visited), typically.
  template <class Visit>
  void visit_nearest(const Vector& point, const double& most, Visit&& visit) const {
    if (!order_.empty()) visit_nearest_in(all(), point, most, visit);
  }

  /// The box about all. \pre there are boxes
  const Box<Vector>& whole() const { return nodes_[1]; }

 private:
  static constexpr Index k_leaf = 4;  ///< boxes in a leaf, at most
  struct Center {
    Vector twice;
    Index box;
  };

  /// `begin` is the first one's place.
  const Box<Vector>& build(std::size_t node, std::span<Center> centers, const std::vector<Box<Vector>>& boxes,
                           Index begin, const JobStage& stage) {
    stage.check();
    Box<Vector>& whole = nodes_[node];
    if (centers.size() <= k_leaf) {
      whole = boxes[centers.front().box];
      for (const Center& center : centers) {
        order_[begin] = center.box;
        boxes_[begin++] = boxes[center.box];
        join(whole, boxes[center.box]);
      }
      return whole;
    }
    Box<Vector> among{centers.front().twice, centers.front().twice};
    for (const Center& center : centers) join(among, {center.twice, center.twice});
    int axis = 0;
    (among.high - among.low).maxCoeff(&axis);
    const std::size_t half = centers.size() / 2;
    std::ranges::nth_element(centers, centers.begin() + half, {},
                             [axis](const Center& center) { return std::pair(center.twice[axis], center.box); });
    whole = build(2 * node, centers.first(half), boxes, begin, stage);
    join(whole, build(2 * node + 1, centers.subspan(half), boxes, begin + static_cast<Index>(half), stage));
    return whole;
  }

  static void join(Box<Vector>& whole, const Box<Vector>& part) {
    whole = {whole.low.cwiseMin(part.low), whole.high.cwiseMax(part.high)};
  }

  /// Leaves out what comes before `first`.
  template <class Visit>
  void visit_node(std::size_t node, Index begin, Index end, Index first, const Box<Vector>& box, Visit&& visit) const {
    if (end <= first || !nodes_[node].meets(box)) return;
    if (end - begin <= k_leaf) {
      for (Index i = std::max(begin, first); i < end; ++i)
        if (boxes_[i].meets(box)) visit(order_[i]);
      return;
    }
    const Index middle = begin + (end - begin) / 2;
    visit_node(2 * node, begin, middle, first, box, visit);
    visit_node(2 * node + 1, middle, end, first, box, visit);
  }

  struct Part {
    std::size_t node;
    Index begin, end;
    Index size() const { return end - begin; }
    Part half(int side) const {
      const Index middle = begin + size() / 2;
      return {2 * node + side, side ? middle : begin, side ? end : middle};
    }
  };
  Part all() const { return {1, 0, static_cast<Index>(order_.size())}; }

  static double squared_distance(const Box<Vector>& box, const Vector& point) {
    return (box.low - point).cwiseMax(point - box.high).cwiseMax(0).squaredNorm();
  }

  template <class Visit>
  void visit_nearest_in(const Part& part, const Vector& point, const double& most, Visit&& visit) const {
    constexpr double k_rounding = 1e-12;
    const auto is_far = [&](const Box<Vector>& box) { return squared_distance(box, point) * (1 - k_rounding) > most; };
    if (is_far(nodes_[part.node])) return;
    if (part.size() <= k_leaf) {
      for (Index i = part.begin; i < part.end; ++i)
        if (!is_far(boxes_[i])) visit(order_[i]);
      return;
    }
    const int nearer =
        squared_distance(nodes_[2 * part.node + 1], point) < squared_distance(nodes_[2 * part.node], point);
    for (const int side : {nearer, 1 - nearer}) visit_nearest_in(part.half(side), point, most, visit);
  }

  template <class Visit>
  void visit_parts(const Part& part, const BoxTree& other, const Part& of_other, Visit&& visit) const {
    if (!nodes_[part.node].meets(other.nodes_[of_other.node])) return;
    if (std::max(part.size(), of_other.size()) <= k_leaf) {
      for (Index i = part.begin; i < part.end; ++i)
        for (Index j = of_other.begin; j < of_other.end; ++j)
          if (boxes_[i].meets(other.boxes_[j])) visit(order_[i], other.order_[j]);
      return;
    }
    for (const int side : {0, 1})
      if (part.size() > of_other.size())
        visit_parts(part.half(side), other, of_other, visit);
      else
        visit_parts(part, other, of_other.half(side), visit);
  }

  std::vector<Box<Vector>> boxes_, nodes_;  ///< boxes in the tree's order
  std::vector<Index> order_;
};

}  // namespace saddleback
