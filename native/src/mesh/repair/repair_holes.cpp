// Holes are filled by the triangulation of least area, found by dynamic programming over chords [barequet1995]. No
// chord repeats an edge of the mesh, so that what was manifold stays so.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <unordered_set>

#include "mesh/repair/repair_borders.h"
#include "mesh/tables/edge_table.h"

namespace saddleback {
namespace {

constexpr double k_never = std::numeric_limits<double>::infinity();

/// The edges of the mesh and those that filling adds, each by its vertices.
class EdgeSet {
 public:
  EdgeSet(std::span<const Triangle> triangles, const EdgeTable& table) {
    for (Index e = 0; e < table.edge_count(); ++e)
      given_.push_back(key(halfedge_from(triangles, table.edge(e)[0]), halfedge_to(triangles, table.edge(e)[0])));
    std::sort(given_.begin(), given_.end());
  }

  bool contains(Index a, Index b) const {
    return added_.contains(key(a, b)) || std::binary_search(given_.begin(), given_.end(), key(a, b));
  }
  void add(Index a, Index b) { added_.insert(key(a, b)); }

 private:
  static std::uint64_t key(Index a, Index b) {
    return static_cast<std::uint64_t>(std::min(a, b)) << 32 | static_cast<std::uint64_t>(std::max(a, b));
  }
  std::vector<std::uint64_t> given_;
  std::unordered_set<std::uint64_t> added_;
};

/// A border loop as new faces go round it, against the direction of the faces that are there.
struct BorderLoop {
  std::vector<Index> vertices;
  Index face = k_none;  ///< one of those along it
};

std::vector<BorderLoop> border_loops(std::span<const Triangle> triangles, const EdgeTable& edges) {
  std::unordered_map<Index, Index> before;  // \pre manifold: one border half-edge ends at a border vertex
  for (Index e = 0; e < edges.edge_count(); ++e)
    if (const auto around = edges.edge(e); around.size() == 1) before[halfedge_to(triangles, around[0])] = around[0];
  std::vector<BorderLoop> loops;
  std::vector<Index> starts;
  for (const auto& [vertex, halfedge] : before) starts.push_back(vertex);
  std::sort(starts.begin(), starts.end());
  for (const Index start : starts) {
    BorderLoop loop;
    for (auto at = before.find(start); at != before.end(); at = before.find(loop.vertices.back())) {
      loop.vertices.push_back(halfedge_from(triangles, at->second));
      loop.face = at->second / 3;
      before.erase(at);
    }
    if (loop.vertices.size() >= 3) loops.push_back(std::move(loop));
  }
  return loops;
}

class LeastArea {
 public:
  LeastArea(std::span<const Vec3> positions, const EdgeSet& edges, const std::vector<Index>& loop)
      : positions_(positions), edges_(edges), loop_(loop), count_(static_cast<Index>(loop.size())) {}

  /// The faces, none where every triangulation would repeat an edge of the mesh.
  std::vector<Triangle> faces(const JobStage& stage) {
    area_.assign(static_cast<std::size_t>(count_) * count_, 0);
    apex_.assign(area_.size(), k_none);
    for (Index span = 2; span < count_; ++span) {
      stage.check();
      for (Index i = 0; i + span < count_; ++i) choose_apex(i, i + span);
    }
    std::vector<Triangle> result;
    if (area_[place(0, count_ - 1)] < k_never) collect(result);
    return result;
  }

 private:
  std::size_t place(Index i, Index j) const { return static_cast<std::size_t>(i) * count_ + j; }
  const Vec3& at(Index i) const { return positions_[loop_[i]]; }

  void choose_apex(Index i, Index j) {
    double& best = area_[place(i, j)] = k_never;
    if (j - i < count_ - 1 && edges_.contains(loop_[i], loop_[j])) return;
    const Vec3 side = at(j) - at(i);
    for (Index k = i + 1; k < j; ++k) {
      const double area = area_[place(i, k)] + area_[place(k, j)] + side.cross(at(k) - at(i)).norm();
      if (area >= best) continue;
      best = area;
      apex_[place(i, j)] = k;
    }
  }

  void collect(std::vector<Triangle>& result) const {
    std::vector<std::pair<Index, Index>> open{{0, count_ - 1}};
    while (!open.empty()) {
      const auto [i, j] = open.back();
      open.pop_back();
      if (j - i < 2) continue;
      const Index k = apex_[place(i, j)];
      result.push_back({loop_[i], loop_[k], loop_[j]});
      open.insert(open.end(), {{i, k}, {k, j}});
    }
  }

  std::span<const Vec3> positions_;
  const EdgeSet& edges_;
  const std::vector<Index>& loop_;
  Index count_;
  std::vector<double> area_;
  std::vector<Index> apex_;
};

}  // namespace

void fill_holes(RepairState& state, Index most_edges, const JobStage& stage) {
  std::vector<Triangle> triangles;
  for (const Index f : state.live_faces()) triangles.push_back(state.triangles[f]);
  const EdgeTable table = build_edge_table(triangles, state.vertex_count(), stage);
  EdgeSet edges(triangles, table);
  for (const auto& [loop, along] : border_loops(triangles, table)) {
    // A loop of three about a single face would only give it a back.
    const bool is_lone_face =
        loop.size() == 3 && std::is_permutation(loop.begin(), loop.end(), triangles[along].begin());
    std::vector<Triangle> faces;
    if (static_cast<Index>(loop.size()) <= most_edges && !is_lone_face)
      faces = LeastArea(state.positions, edges, loop).faces(stage);
    state.count(faces.empty() ? "holes_left" : "holes_filled");
    for (const Triangle& face : faces) {
      state.add_face(face);
      for (int i = 0; i < 3; ++i) edges.add(face[i], face[(i + 1) % 3]);
    }
  }
}

}  // namespace saddleback
