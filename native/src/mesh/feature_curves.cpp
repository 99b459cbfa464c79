#include "saddleback/mesh/feature_curves.h"

#include <algorithm>
#include <numbers>

#include "saddleback/error.h"

#include "mesh/tables/outgoing.h"
#include "support/disjoint_sets.h"

namespace saddleback {
namespace {

void check_angle(const char* name, double angle) {
  if (!(angle >= 0 && angle <= std::numbers::pi))
    throw InputError(message(name, ": wanted radians from 0 to pi, got ", angle));
}

Vec3 normal(const Mesh& mesh, Index face) {
  const Triangle& t = mesh.triangles()[face];
  const Vec3 &a = mesh.position(t[0]), &b = mesh.position(t[1]), &c = mesh.position(t[2]);
  return (b - a).cross(c - a);
}

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// Knows which edges are features, and how they meet.
class FeatureGraph {
 public:
  FeatureGraph(const Mesh& mesh, const FeatureCurveOptions& options)
      : mesh_(mesh), corner_angle_(options.corner_angle), is_feature_(mesh.halfedge_count(), 0) {
    for (const Index h : mesh.edge_halfedges()) {
      const Index twin = mesh.twin(h);
      const bool wanted = twin == k_none ? options.boundary
                                         : angle_between(normal(mesh, Mesh::face_of(h)),
                                                         normal(mesh, Mesh::face_of(twin))) > options.angle;
      if (wanted) mark(h);
    }
    std::vector<std::uint8_t> is_kept(mesh.halfedge_count(), 0);
    for (std::size_t i = 0; i < options.edges.size(); ++i) {
      const Index h = given_edge(mesh, options.edges[i], i);
      mark(h);
      is_kept[h] = 1;
      if (mesh.twin(h) != k_none) is_kept[mesh.twin(h)] = 1;
    }
    if (options.least_length > 0) drop_short(options.least_length, is_kept);
    link();
  }

  /// Chains of vertices; of a closed one the first is not repeated.
  struct Chain {
    std::vector<Index> vertices;
    bool closed;
  };
  std::vector<Chain> chains() {
    std::vector<Chain> found;
    for (Index vertex = 0; vertex < mesh_.vertex_count(); ++vertex) {
      if (!is_end(vertex)) continue;
      for (Index i = first_[vertex]; i < first_[vertex + 1]; ++i)
        if (!is_walked_[i]) found.push_back({walk(i), false});
    }
    for (Index vertex = 0; vertex < mesh_.vertex_count(); ++vertex) {
      if (first_[vertex] == first_[vertex + 1] || is_walked_[first_[vertex]]) continue;
      found.push_back({walk(first_[vertex]), true});
      found.back().vertices.pop_back();
    }
    std::ranges::stable_sort(found, {}, [](const Chain& chain) { return chain.vertices.front(); });
    return found;
  }

 private:
  void mark(Index h, std::uint8_t is_feature = 1) {
    is_feature_[h] = is_feature;
    if (mesh_.twin(h) != k_none) is_feature_[mesh_.twin(h)] = is_feature;
  }

  /// Edges within the surface that hang together, and are shorter in all, are no features; but for those to be kept.
  void drop_short(double least_length, const std::vector<std::uint8_t>& is_kept) {
    DisjointSets sets(mesh_.vertex_count());
    std::vector<double> length(mesh_.vertex_count(), 0.0);
    for (const Index h : mesh_.edge_halfedges())
      if (is_feature_[h]) sets.join(mesh_.from(h), mesh_.to(h));
    for (const Index h : mesh_.edge_halfedges())
      if (is_feature_[h]) length[sets.root(mesh_.from(h))] += mesh_.length(h);
    for (const Index h : mesh_.edge_halfedges())
      if (is_feature_[h] && !is_kept[h] && mesh_.twin(h) != k_none && length[sets.root(mesh_.from(h))] < least_length)
        mark(h, 0);
  }

  /// Neighbors along feature edges, by vertex.
  void link() {
    first_.assign(mesh_.vertex_count() + 1, 0);
    const auto each = [&](auto&& visit) {
      for (const Index h : mesh_.edge_halfedges()) {
        if (!is_feature_[h]) continue;
        visit(mesh_.from(h), mesh_.to(h));
        visit(mesh_.to(h), mesh_.from(h));
      }
    };
    each([&](Index from, Index) { ++first_[from + 1]; });
    for (Index vertex = 0; vertex < mesh_.vertex_count(); ++vertex) first_[vertex + 1] += first_[vertex];
    neighbors_.resize(first_.back());
    std::vector<Index> next(first_.begin(), first_.end() - 1);
    each([&](Index from, Index to) { neighbors_[next[from]++] = to; });
    is_walked_.assign(neighbors_.size(), 0);
  }

  /// Returns where lines end: but for those that go on, and turn little.
  bool is_end(Index vertex) const {
    const Index count = first_[vertex + 1] - first_[vertex];
    if (count != 2) return count > 0;
    const Vec3& here = mesh_.position(vertex);
    const Vec3 in = here - mesh_.position(neighbors_[first_[vertex]]);
    const Vec3 out = mesh_.position(neighbors_[first_[vertex] + 1]) - here;
    return angle_between(in, out) > corner_angle_;
  }

  Index link_back(Index from, Index to) const {
    Index i = first_[to];
    while (neighbors_[i] != from) ++i;
    return i;
  }

  /// Walks along a link and on, to an end or back to the start.
  std::vector<Index> walk(Index link) {
    Index vertex = static_cast<Index>(std::ranges::upper_bound(first_, link) - first_.begin()) - 1;
    const Index start = vertex;
    std::vector<Index> chain{vertex};
    while (true) {
      const Index next = neighbors_[link], back = link_back(vertex, next);
      is_walked_[link] = is_walked_[back] = 1;
      chain.push_back(next);
      vertex = next;
      if (vertex == start || is_end(vertex)) return chain;
      link = back == first_[vertex] ? back + 1 : first_[vertex];
    }
  }

  const Mesh& mesh_;
  const double corner_angle_;
  std::vector<std::uint8_t> is_feature_;  ///< by half-edge
  std::vector<Index> first_, neighbors_;  ///< by vertex
  std::vector<std::uint8_t> is_walked_;   ///< by neighbors_
};

}  // namespace

std::vector<SurfaceCurve> feature_curves(const Mesh& mesh, const FeatureCurveOptions& options) {
  mesh.require_space("feature_curves");
  check_angle("angle", options.angle);
  check_angle("corner_angle", options.corner_angle);
  if (!(options.least_length >= 0) || std::isinf(options.least_length))
    throw InputError(message("least_length: wanted a finite length of 0 or more, got ", options.least_length));
  std::vector<SurfaceCurve> curves;
  for (const FeatureGraph::Chain& chain : FeatureGraph(mesh, options).chains()) {
    SurfacePoints points;
    for (const Index vertex : chain.vertices) points.push_back(at_vertex(mesh, vertex));
    curves.emplace_back(mesh, std::move(points), chain.closed);
  }
  return curves;
}

}  // namespace saddleback
