// Boxes about triangles in a tree, halved where their middles are; of two triangles whose boxes meet, exact signs tell
// whether an edge of one passes through the other.

#include <algorithm>
#include <numeric>

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

using Corners = std::array<Vec3, 3>;
using Sides = std::array<int, 3>;  ///< of a plane, on which the corners of a triangle lie

/// Tells whether all that is off the plane is on one side of it, and there is something.
bool is_beside(const Sides& sides) {
  const auto [least, most] = std::ranges::minmax(sides);
  return (least >= 0) != (most <= 0);
}

/// Tells whether the segment passes between the sides of a triangle on whose different sides its ends lie.
bool is_between(const Vec3& from, const Vec3& to, const Corners& t) {
  const int side = orient_3d(from, to, t[0], t[1]);
  return side != 0 && orient_3d(from, to, t[1], t[2]) == side && orient_3d(from, to, t[2], t[0]) == side;
}

bool pierces(const Corners& corners, const Sides& sides, const Corners& other) {
  for (int i = 0; i < 3; ++i) {
    const int next = (i + 1) % 3;
    if (sides[i] * sides[next] < 0 && is_between(corners[i], corners[next], other)) return true;
  }
  return false;
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
    int shared = 0, at_a = k_none, at_b = k_none;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (of_a[i] == of_b[j]) ++shared, at_a = i, at_b = j;
    if (shared > 1) return false;
    // A triangle beside the other's plane has no inner point in it, so nothing passes through either.
    const Corners first = corners(a), second = corners(b);
    const Sides of_first = sides(second, first, at_a);
    if (is_beside(of_first)) return false;
    const Sides of_second = sides(first, second, at_b);
    if (is_beside(of_second)) return false;
    return pierces(first, of_first, second) || pierces(second, of_second, first);
  }

 private:
  static constexpr int k_none = -1;
  Corners corners(Index i) const {
    const Triangle& t = triangles_[i];
    return {vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]};
  }
  /// `shared` is the corner that lies in the plane since it is one of the plane's own.
  static Sides sides(const Corners& plane, const Corners& of, int shared) {
    Sides found{};
    for (int i = 0; i < 3; ++i)
      if (i != shared) found[i] = orient_3d(plane[0], plane[1], plane[2], of[i]);
    return found;
  }

  std::span<const Vec3> vertices_;
  std::span<const Triangle> triangles_;
};

/// All of `count` triangles, or those that are named.
std::vector<Index> chosen_of(std::optional<std::span<const Index>> among, Index count) {
  if (!among) {
    std::vector<Index> all(count);
    std::iota(all.begin(), all.end(), 0);
    return all;
  }
  for (std::size_t k = 0; k < among->size(); ++k)
    if ((*among)[k] <= (k ? (*among)[k - 1] : -1) || (*among)[k] >= count)
      throw InputError(
          message("among: entry ", k, " is ", (*among)[k], "; name each of ", count, " triangles once, in order"));
  return {among->begin(), among->end()};
}

/// Triangles that are not held against each other: those of one owner, or all where nobody says whose they are.
struct Group {
  std::vector<Index> triangles;
  BoxTree<Vec3> tree;
};

std::vector<Group> groups_of(std::vector<Index> chosen, std::optional<std::span<const Index>> owners,
                             const Crossings& crossings, int threads, const JobStage& stage) {
  const auto owner = [&](Index i) { return owners ? (*owners)[i] : 0; };
  std::ranges::stable_sort(chosen, {}, owner);
  std::vector<Group> groups;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    if (k == 0 || owner(chosen[k]) != owner(chosen[k - 1])) groups.emplace_back();
    groups.back().triangles.push_back(chosen[k]);
  }
  parallel_for(static_cast<Index>(groups.size()), threads, 1, [&](Index g, int) {
    stage.check();
    std::vector<Box<Vec3>> boxes;
    for (const Index i : groups[g].triangles) {
      stage.check();
      boxes.push_back(crossings.box(i));
    }
    groups[g].tree = BoxTree<Vec3>(boxes, stage);
  });
  return groups;
}

}  // namespace

std::vector<std::array<Index, 2>> self_crossings(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                                                 std::optional<std::span<const Index>> among,
                                                 std::optional<std::span<const Index>> owners, int threads,
                                                 const JobStage& stage) {
  const auto count = static_cast<Index>(triangles.size());
  check_corners(triangles, static_cast<Index>(vertices.size()));
  for (std::size_t v = 0; v < vertices.size(); ++v)
    if (!vertices[v].allFinite()) throw InputError(message("vertices: vertex ", v, " is not finite"));
  if (owners && owners->size() != triangles.size())
    throw InputError(message("owners: ", owners->size(), " of them; name that of each of ", count, " triangles"));
  const std::vector<Index> chosen = chosen_of(among, count);
  const Crossings crossings(vertices, triangles);
  const std::vector<Group> groups = groups_of(chosen, owners, crossings, threads, stage);
  std::vector<Box<Vec3>> boxes;
  for (const Group& group : groups) boxes.push_back(group.tree.whole());
  const BoxTree<Vec3> tree(boxes, stage);

  struct alignas(k_apart) Worker {
    std::vector<std::array<Index, 2>> found;
  };
  std::vector<Worker> workers(thread_count(threads));
  const auto look = [&](Index a, Index b, int thread) {
    stage.check();  // in a heap of triangles one meets thousands
    if (crossings.cross(a, b)) workers[thread].found.push_back({std::min(a, b), std::max(a, b)});
  };
  if (owners) {
    parallel_for(static_cast<Index>(groups.size()), threads, 1, [&](Index place, int thread) {
      tree.visit_later(place, [&](Index g, Index h) {
        groups[g].tree.visit_both(
            groups[h].tree, [&](Index i, Index j) { look(groups[g].triangles[i], groups[h].triangles[j], thread); });
      });
    });
  } else if (!groups.empty()) {
    parallel_for(static_cast<Index>(chosen.size()), threads, k_at_once, [&](Index place, int thread) {
      if (place % k_at_once == 0) stage.check();
      groups[0].tree.visit_later(place, [&](Index i, Index j) { look(chosen[i], chosen[j], thread); });
    });
  }
  std::vector<bool> is_chosen(count);
  for (const Index i : chosen) is_chosen[i] = true;
  parallel_for(among ? count : 0, threads, k_at_once, [&](Index other, int thread) {
    if (other % k_at_once == 0) stage.check();
    if (is_chosen[other]) return;
    const Box<Vec3> box = crossings.box(other);
    tree.visit(box, [&](Index g) {
      const std::vector<Index>& own = groups[g].triangles;
      if (owners && (*owners)[own[0]] == (*owners)[other]) return;
      groups[g].tree.visit(box, [&](Index i) { look(own[i], other, thread); });
    });
  });
  std::vector<std::array<Index, 2>> all;
  for (const Worker& worker : workers) all.insert(all.end(), worker.found.begin(), worker.found.end());
  std::ranges::sort(all);
  stage.update(1);
  return all;
}

}  // namespace saddleback
