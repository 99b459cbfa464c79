#include "charts/stroke_sweep.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>

#include "mesh/tables/edge_key.h"
#include "mesh/tables/edge_table.h"
#include "support/disjoint_sets.h"

namespace saddleback::charts {
namespace {

// As a share of the radius: how much farther away a vertex must be than those that it covers. On a lower step next to
// nothing would hold these but their neighbors at the same height.
constexpr double k_step = 3e-5;

std::uint64_t directed(Index from, Index to) {
  return static_cast<std::uint64_t>(from) << 32 | static_cast<std::uint32_t>(to);
}

class Sweep {
 public:
  Sweep(Sheet& sheet, const PartedSheet& parted, const SideBorder& border, double radius,
        std::vector<std::uint8_t>& taken)
      : sheet_(sheet), parted_(parted), border_(border), radius_(radius), step_(k_step * radius), taken_(taken) {
    const std::size_t count = parted.nodes.size();
    next_.assign(count, k_none);
    prev_.assign(count, k_none);
    live_.assign(count, k_none);
    is_taken_.assign(count, 0);
    is_waiting_.assign(count, 0);
    swept_.held.assign(count, Held::nothing);
    swept_.is_last.assign(count, 0);
    for (const Index h : border.curve) {
      if (h == k_none) continue;
      const Index a = parted.from(h), b = parted.from(PartedSheet::next(h));
      next_[a] = b;
      prev_[b] = a;
      live_[a] = h;
      swept_.is_last[a] = swept_.is_last[b] = 1;
    }
  }

  SweptSide run(const JobStage& stage) {
    for (std::size_t v = 0; v < parted_.nodes.size(); ++v)
      if (swept_.is_last[v]) wait_about(static_cast<Index>(v));
    while (!waiting_.empty()) {
      stage.check();
      const Index v = waiting_.top().second;
      waiting_.pop();
      is_waiting_[v] = 0;
      take(v);
    }
    std::ranges::sort(swept_.vertices, {}, [&](Index v) { return std::pair(distance(v), v); });
    return std::move(swept_);
  }

 private:
  /// Vertices about one on the chain wait for their turn; those that could not be taken do once more.
  void wait_about(Index vertex) {
    for (Index i = parted_.begins[vertex]; i < parted_.begins[vertex + 1]; ++i) {
      for (const Index h : {PartedSheet::next(parted_.stars[i]), PartedSheet::prev(parted_.stars[i])}) {
        const Index v = parted_.from(h);
        if (is_taken_[v] || is_waiting_[v] || distance(v) == 0) continue;
        is_waiting_[v] = 1;
        waiting_.emplace(distance(v), v);
      }
    }
  }

  double distance(Index v) const { return sheet_.distance[parted_.nodes[v]]; }

  /// Tells whether the triangle at this corner stands on the chain.
  bool stands(Index corner) const {
    const Index below = PartedSheet::next(corner), a = parted_.from(below);
    return live_[a] == below && next_[a] == parted_.from(PartedSheet::next(below)) && !taken_[corner / 3];
  }

  double angle(Index corner) const {
    const auto at = [&](Index h) -> const Vec3& { return sheet_.positions[parted_.nodes[parted_.from(h)]]; };
    const Vec3 a = at(PartedSheet::next(corner)) - at(corner), b = at(PartedSheet::prev(corner)) - at(corner);
    return std::atan2(a.cross(b).norm(), a.dot(b));
  }

  /// Finds the widest run of triangles about the vertex that stand on the chain side by side, left to right.
  void find_run(Index vertex) {
    run_.clear();
    double widest = 0;
    std::vector<Index>& corners = candidate_;
    for (Index i = parted_.begins[vertex]; i < parted_.begins[vertex + 1]; ++i) {
      const Index first = parted_.stars[i];
      if (!stands(first)) continue;
      if (const Index before = parted_.twins[first]; before != k_none && stands(PartedSheet::next(before))) continue;
      corners.clear();
      double width = 0;
      bool is_above = false;
      double covered = 0;
      for (Index corner = first; corner != k_none && stands(corner);) {
        if (!corners.empty()) covered = std::max(covered, distance(parted_.from(PartedSheet::next(corner))));
        corners.push_back(corner);
        width += angle(corner);
        for (const Index below : {PartedSheet::next(corner), PartedSheet::prev(corner)})
          is_above |= distance(parted_.from(below)) + step_ <= distance(vertex);
        corner = parted_.twins[PartedSheet::prev(corner)];
        if (corner == first) break;
      }
      const double needed = corners.size() > 1 ? covered + step_ : 0;
      if (!is_above || width <= widest || needed > std::min(distance(vertex) + 2 * step_, radius_)) continue;
      widest = width;
      lifted_ = std::max(distance(vertex), needed);
      run_.swap(corners);
    }
  }

  void take(Index vertex) {
    find_run(vertex);
    if (run_.empty()) return;
    sheet_.distance[parted_.nodes[vertex]] = lifted_;
    const Index left = parted_.from(PartedSheet::next(run_.front()));
    const Index right = parted_.from(PartedSheet::prev(run_.back()));
    for (const Index corner : run_) {
      taken_[corner / 3] = 1;
      swept_.triangles.push_back(corner / 3);
      if (corner != run_.front()) drop(parted_.from(PartedSheet::next(corner)));
    }
    swept_.vertices.push_back(vertex);
    swept_.is_last[vertex] = is_taken_[vertex] = 1;
    link(left, vertex, parted_.twins[run_.front()]);
    link(vertex, right, parted_.twins[PartedSheet::prev(run_.back())]);
    // The curve's first line across, whose half-edges lead down to it, and its last, whose half-edges lead up.
    if (starts_ < border_.start.size() && border_.start[starts_] == run_.front() && prev_[left] == k_none) {
      ++starts_;
      swept_.held[vertex] = Held::at_start;
      drop(left);
    } else if (ends_ < border_.end.size() && border_.end[ends_] == PartedSheet::prev(run_.back()) &&
               next_[right] == k_none) {
      ++ends_;
      swept_.held[vertex] = Held::at_end;
      drop(right);
    }
    close(prev_[vertex]);
    close(next_[vertex]);
    wait_about(vertex);
  }

  /// Takes a triangle that stands on both edges of the chain at a vertex that it leaves below.
  void close(Index vertex) {
    if (vertex == k_none || prev_[vertex] == k_none || next_[vertex] == k_none) return;
    const Index before = prev_[vertex], after = next_[vertex], h = live_[before];
    if (h == k_none || live_[vertex] != PartedSheet::next(h) || taken_[h / 3]) return;
    if (distance(vertex) + step_ > std::max(distance(before), distance(after))) return;
    taken_[h / 3] = 1;
    swept_.triangles.push_back(h / 3);
    drop(vertex);
    link(before, after, parted_.twins[PartedSheet::prev(h)]);
    close(before);
    close(after);
  }

  void link(Index a, Index b, Index halfedge) {
    next_[a] = b;
    prev_[b] = a;
    live_[a] = halfedge;
  }

  void drop(Index vertex) {
    if (const Index after = next_[vertex]; after != k_none && prev_[after] == vertex) prev_[after] = k_none;
    if (const Index before = prev_[vertex]; before != k_none && next_[before] == vertex) {
      next_[before] = k_none;
      live_[before] = k_none;
    }
    next_[vertex] = prev_[vertex] = live_[vertex] = k_none;
    swept_.is_last[vertex] = 0;
  }

  Sheet& sheet_;
  const PartedSheet& parted_;
  const SideBorder& border_;
  const double radius_, step_;
  std::vector<std::uint8_t>& taken_;
  SweptSide swept_;
  std::vector<Index> next_, prev_;  ///< along the chain
  std::vector<Index> live_;         ///< half-edge to the next vertex of the chain, in the triangle above it
  std::vector<Index> run_, candidate_;
  double lifted_ = 0;  ///< distance of the vertex whose run is at hand
  std::size_t starts_ = 0, ends_ = 0;
  std::vector<std::uint8_t> is_taken_, is_waiting_;
  using Turn = std::pair<double, Index>;
  std::priority_queue<Turn, std::vector<Turn>, std::greater<>> waiting_;
};

}  // namespace

PartedSheet::PartedSheet(const Sheet& sheet, const JobStage& stage) {
  const auto count = static_cast<Index>(3 * sheet.triangles.size());
  twins.assign(count, k_none);
  DisjointSets corners(count);
  const EdgeTable edges = build_edge_table(sheet.triangles, static_cast<Index>(sheet.points.size()));
  for (Index e = 0; e < edges.edge_count(); ++e) {
    stage.check();
    const auto around = edges.edge(e);
    if (around.size() != 2) continue;
    const Index h = around[0], t = around[1];
    if (sheet.walls.contains(edge_key(halfedge_from(sheet.triangles, h), halfedge_to(sheet.triangles, h)))) continue;
    twins[h] = t;
    twins[t] = h;
    corners.join(h, next(t));
    corners.join(next(h), t);
  }
  vertices.resize(count);
  std::vector<std::uint8_t> is_on_line(sheet.points.size(), 0);
  for (const Index node : sheet.curve) is_on_line[node] = 1;
  for (const std::vector<Index>& line : sheet.across)
    for (const Index node : line) is_on_line[node] = 1;
  for (Index h = 0; h < count; ++h) {
    stage.check();
    const Index root = corners.root(h), node = halfedge_from(sheet.triangles, h);
    if (root == h) {
      vertices[h] = static_cast<Index>(nodes.size());
      nodes.push_back(node);
    } else {
      vertices[h] = vertices[root];
    }
    if (const Index to = halfedge_to(sheet.triangles, h); is_on_line[node] && is_on_line[to])
      by_nodes_.emplace_back(directed(node, to), h);
  }
  std::ranges::sort(by_nodes_);
  stage.check();
  begins.assign(nodes.size() + 1, 0);
  for (const Index v : vertices) ++begins[v + 1];
  for (std::size_t v = 0; v < nodes.size(); ++v) begins[v + 1] += begins[v];
  stars.resize(count);
  std::vector<Index> place(begins.begin(), begins.end() - 1);
  for (Index h = 0; h < count; ++h) stars[place[vertices[h]]++] = h;
}

Index PartedSheet::halfedge(Index from_node, Index to_node) const {
  const std::uint64_t key = directed(from_node, to_node);
  const auto found = std::ranges::lower_bound(by_nodes_, key, {}, &std::pair<std::uint64_t, Index>::first);
  return found != by_nodes_.end() && found->first == key ? found->second : k_none;
}

SweptSide sweep_side(Sheet& sheet, const PartedSheet& parted, const SideBorder& border, double radius,
                     std::vector<std::uint8_t>& taken, const JobStage& stage) {
  return Sweep(sheet, parted, border, radius, taken).run(stage);
}

}  // namespace saddleback::charts
