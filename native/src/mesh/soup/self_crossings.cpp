// Boxes about triangles in a tree, halved where their middles are; of two triangles whose boxes meet, exact signs tell
// whether an edge of one passes through the other.

#include <algorithm>
#include <numeric>

#include "saddleback/error.h"
#include "saddleback/mesh/triangle_arrays.h"

#include "mesh/tables/corner_table.h"
#include "predicates/orient_3d.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

using predicates::orient_3d;

constexpr Index k_most_in_leaf = 4;
// Triangles between two looks at the job, and that a thread takes at a time.
constexpr Index k_at_once = 256;

struct Box {
  Vec3 low, high;
  bool meets(const Box& other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
};

class BoxTree {
 public:
  explicit BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    if (!order_.empty()) add_node(0, static_cast<Index>(order_.size()));
  }
  const Box& box(Index i) const { return boxes_[i]; }

  /// Calls visit(i) for all whose boxes meet the given one.
  template <class Visit>
  void visit_meeting(const Box& box, std::vector<Index>& stack, Visit&& visit) const {
    stack.assign(nodes_.empty() ? 0 : 1, 0);
    while (!stack.empty()) {
      const Node& node = nodes_[stack.back()];
      stack.pop_back();
      if (!node.box.meets(box)) continue;
      if (node.right == k_none) {
        for (Index i = node.first; i < node.last; ++i)
          if (boxes_[order_[i]].meets(box)) visit(order_[i]);
      } else {
        const Index left = static_cast<Index>(&node - nodes_.data()) + 1;
        stack.push_back(left);
        stack.push_back(node.right);
      }
    }
  }

 private:
  struct Node {
    Box box;
    Index first, last;
    Index right;  ///< the left child follows its parent; k_none: a leaf
  };

  Index add_node(Index first, Index last) {
    const auto number = static_cast<Index>(nodes_.size());
    Box all = boxes_[order_[first]];
    for (Index i = first + 1; i < last; ++i) {
      all.low = all.low.cwiseMin(boxes_[order_[i]].low);
      all.high = all.high.cwiseMax(boxes_[order_[i]].high);
    }
    nodes_.push_back({all, first, last, k_none});
    if (last - first <= k_most_in_leaf) return number;
    int axis = 0;
    (all.high - all.low).maxCoeff(&axis);
    const Index middle = first + (last - first) / 2;
    const auto twice_center = [&](Index i) { return boxes_[i].low[axis] + boxes_[i].high[axis]; };
    std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last, [&](Index a, Index b) {
      const double at_a = twice_center(a), at_b = twice_center(b);
      return at_a != at_b ? at_a < at_b : a < b;
    });
    add_node(first, middle);
    const Index right = add_node(middle, last);
    nodes_[number].right = right;
    return number;
  }

  std::vector<Box> boxes_;
  std::vector<Index> order_;
  std::vector<Node> nodes_;
};

/// Tells whether the segment's ends lie on different sides of the triangle's plane, and it passes between its sides.
bool pierces(const Vec3& from, const Vec3& to, const std::array<Vec3, 3>& t) {
  if (orient_3d(t[0], t[1], t[2], from) * orient_3d(t[0], t[1], t[2], to) >= 0) return false;
  const int side = orient_3d(from, to, t[0], t[1]);
  return side != 0 && orient_3d(from, to, t[1], t[2]) == side && orient_3d(from, to, t[2], t[0]) == side;
}

class Crossings {
 public:
  Crossings(std::span<const Vec3> vertices, std::span<const Triangle> triangles)
      : vertices_(vertices), triangles_(triangles) {}

  Box box(Index i) const {
    const auto [a, b, c] = corners(i);
    return {a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)};
  }
  bool cross(Index a, Index b) const {
    const Triangle &of_a = triangles_[a], &of_b = triangles_[b];
    int shared = 0, at_a = 0, at_b = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (of_a[i] == of_b[j]) ++shared, at_a = i, at_b = j;
    if (shared > 1) return false;
    // Where they share a corner, the line that they share begins there and ends on the side opposite of one of them.
    return any_pierces(a, corners(b), shared ? (at_a + 1) % 3 : k_all_sides) ||
           any_pierces(b, corners(a), shared ? (at_b + 1) % 3 : k_all_sides);
  }

 private:
  static constexpr int k_all_sides = -1;
  std::array<Vec3, 3> corners(Index i) const {
    const Triangle& t = triangles_[i];
    return {vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]};
  }
  bool any_pierces(Index triangle, const std::array<Vec3, 3>& other, int side) const {
    const auto own = corners(triangle);
    for (int i = 0; i < 3; ++i)
      if ((side == k_all_sides || side == i) && pierces(own[i], own[(i + 1) % 3], other)) return true;
    return false;
  }

  std::span<const Vec3> vertices_;
  std::span<const Triangle> triangles_;
};

}  // namespace

std::vector<std::array<Index, 2>> self_crossings(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                                                 int threads, const JobStage& stage) {
  check_corners(triangles, static_cast<Index>(vertices.size()));
  for (std::size_t v = 0; v < vertices.size(); ++v)
    if (!vertices[v].allFinite()) throw InputError(message("vertices: vertex ", v, " is not finite"));
  const Crossings crossings(vertices, triangles);
  const auto count = static_cast<Index>(triangles.size());
  std::vector<Box> boxes(count);
  for (Index i = 0; i < count; ++i) boxes[i] = crossings.box(i);
  const BoxTree tree(std::move(boxes));
  struct alignas(k_apart) Worker {
    std::vector<Index> stack;
    std::vector<std::array<Index, 2>> found;
  };
  std::vector<Worker> workers(thread_count(threads));
  parallel_for(count, threads, k_at_once, [&](Index i, int thread) {
    if (i % k_at_once == 0) stage.check();
    auto& [stack, found] = workers[thread];
    tree.visit_meeting(tree.box(i), stack, [&](Index other) {
      if (other > i && crossings.cross(i, other)) found.push_back({i, other});
    });
  });
  std::vector<std::array<Index, 2>> all;
  for (const Worker& worker : workers) all.insert(all.end(), worker.found.begin(), worker.found.end());
  std::ranges::sort(all);
  stage.update(1);
  return all;
}

}  // namespace saddleback
