// Boxes about triangles in a tree, halved where their middles are; of two triangles whose boxes meet, exact signs tell
// whether an edge of one passes through the other.

#include <algorithm>

#include "saddleback/error.h"
#include "saddleback/mesh/triangle_arrays.h"

#include "mesh/tables/corner_table.h"
#include "predicates/orient_3d.h"
#include "support/box_tree.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

using predicates::orient_3d;

// Triangles between two looks at the job, and that a thread takes at a time.
constexpr Index k_at_once = 256;

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

  Box<Vec3> box(Index i) const {
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
  std::vector<Box<Vec3>> boxes(count);
  for (Index i = 0; i < count; ++i) boxes[i] = crossings.box(i);
  const BoxTree<Vec3> tree(std::move(boxes));
  struct alignas(k_apart) Worker {
    std::vector<std::array<Index, 2>> found;
  };
  std::vector<Worker> workers(thread_count(threads));
  parallel_for(count, threads, k_at_once, [&](Index i, int thread) {
    if (i % k_at_once == 0) stage.check();
    auto& found = workers[thread].found;
    tree.visit(tree.box(i), [&](Index other) {
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
