#include "tessellation/polygons/parted_surface.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>
#include <unordered_map>

#include "mesh/tables/edge_key.h"
#include "mesh/tables/edge_table.h"
#include "tessellation/polygons/barrier_ends.h"

namespace saddleback {
namespace {

// In parts of an edge: points of both sides of a barrier as near to each other are one.
constexpr double k_same_point = 1e-9;

/// Sews the split cells of a barred mesh together.
class Seam {
 public:
  Seam(const Mesh& whole, const BarredMesh& barred, const GeodesicVoronoi& cells)
      : whole_(whole),
        barred_(barred),
        cells_(cells),
        split_(cells.split(*barred.mesh)),
        point_places_(points_on_whole(whole, barred, cells.points, "cells")) {
    number_barred_vertices();
    follow_barriers();
    for (Edge& edge : edges_) merge(edge);
    for (Index i = barred_count(); i < static_cast<Index>(split_.vertices.size()); ++i)
      if (node_[i] == k_none) node_[i] = new_node(i);
    emit_triangles();
  }
  PartedSurface take() { return std::move(result_); }

 private:
  /// An edge of the barred mesh's boundary: the points that either side has on it, from its smaller node to the other.
  struct Edge {
    Index low;  ///< a node
    std::array<std::vector<Index>, 2> sides;
    std::vector<Index> nodes;  ///< of both
  };
  struct Side {
    std::vector<Index> inner;  ///< nodes between the ends
    bool is_barrier = false;
  };

  Index barred_count() const { return barred_.mesh->vertex_count(); }
  const Vec3& at(Index i) const { return split_.vertices[i]; }

  Index new_node(Index i) {
    result_.places.push_back(i < barred_count() ? barred_.vertex_points[i] : point_places_[i - barred_count()]);
    return whole_.vertex_count() + static_cast<Index>(result_.places.size()) - 1;
  }

  /// All copies of a vertex are one node.
  void number_barred_vertices() {
    node_.assign(split_.vertices.size(), k_none);
    std::map<std::tuple<Index, double, double, double>, Index> on_curves;
    for (Index i = 0; i < barred_count(); ++i) {
      node_[i] = barred_.vertex_origin[i];
      if (node_[i] != k_none) continue;
      const auto& [face, b] = barred_.vertex_points[i];
      const auto [known, is_new] = on_curves.try_emplace({face, b[0], b[1], b[2]}, k_none);
      if (is_new) known->second = new_node(i);
      node_[i] = known->second;
    }
  }

  void follow_barriers() {
    const std::vector<Index> twins = twins_of(split_);
    std::vector<Index> onward(node_.size(), k_none);  // along the boundary, from vertex to vertex
    for (Index h = 0; h < static_cast<Index>(twins.size()); ++h)
      if (twins[h] == k_none) onward[split_.triangles[h / 3][h % 3]] = split_.triangles[h / 3][Mesh::next(h) % 3];
    edge_from_.assign(node_.size(), k_none);
    rank_.assign(node_.size(), k_none);
    std::unordered_map<std::uint64_t, Index> known;
    const Mesh& mesh = *barred_.mesh;
    for (Index h = 0; h < mesh.halfedge_count(); ++h) {
      if (mesh.twin(h) != k_none) continue;
      const Index from = mesh.from(h), to = mesh.to(h);
      const auto [entry, is_first] =
          known.try_emplace(edge_key(node_[from], node_[to]), static_cast<Index>(edges_.size()));
      if (is_first) edges_.push_back({std::min(node_[from], node_[to]), {}, {}});
      std::vector<Index>& side = edges_[entry->second].sides[is_first ? 0 : 1];
      edge_from_[from] = entry->second;
      for (Index i = onward[from]; i != to; i = onward[i]) {
        edge_from_[i] = entry->second;
        side.push_back(i);
      }
      if (node_[from] > node_[to]) std::ranges::reverse(side);
    }
  }

  /// Both sides keep their order; what is in one place becomes one node.
  void merge(Edge& edge) {
    const auto& [first, second] = edge.sides;
    const SurfacePoint low = edge.low < whole_.vertex_count() ? at_vertex(whole_, edge.low)
                                                              : result_.places[edge.low - whole_.vertex_count()];
    const Vec3 begin = position(whole_, low);
    const auto along = [&](Index i) { return (at(i) - begin).norm(); };
    for (auto a = first.begin(), b = second.begin(); a != first.end() || b != second.end();) {
      const double gap = a == first.end() ? 1 : b == second.end() ? -1 : along(*a) - along(*b);
      const bool both = a != first.end() && b != second.end() && std::abs(gap) <= k_same_point * along(*a);
      const Index node = new_node(both || gap < 0 ? *a : *b);
      const auto take = [&](Index i) { node_[i] = node, rank_[i] = static_cast<Index>(edge.nodes.size()); };
      const bool has_first = both || gap < 0, has_second = both || gap >= 0;
      if (has_first) take(*a++);
      if (has_second) take(*b++);
      edge.nodes.push_back(node);
    }
  }

  /// A side of a triangle as it is after merging.
  Side side(Index from, Index to, bool is_boundary) const {
    if (!is_boundary) return {};
    const Edge& edge = edges_[edge_from_[from]];
    const auto count = static_cast<Index>(edge.nodes.size());
    const auto rank = [&](Index i) { return i >= barred_count() ? rank_[i] : node_[i] == edge.low ? -1 : count; };
    const Index begin = rank(from), end = rank(to);
    Side result{{}, true};
    const Index step = begin < end ? 1 : -1;
    for (Index i = begin + step; i != end; i += step) result.inner.push_back(edge.nodes[i]);
    return result;
  }

  void emit_triangles() {
    const std::vector<Index> twins = twins_of(split_);
    for (Index t = 0; t < static_cast<Index>(split_.triangles.size()); ++t) {
      const Triangle& corners = split_.triangles[t];
      std::array<Side, 3> sides;
      for (int i = 0; i < 3; ++i) sides[i] = side(corners[i], corners[(i + 1) % 3], twins[3 * t + i] == k_none);
      emit({node_[corners[0]], node_[corners[1]], node_[corners[2]]}, sides, split_.triangle_cell[t]);
    }
    SplitMesh& split = result_.split;
    for (Index i = 0; i < whole_.vertex_count(); ++i) {
      split.vertices.push_back(whole_.position(i));
      split.vertex_origin.push_back(i);
    }
    for (const SurfacePoint& point : result_.places) split.vertices.push_back(position(whole_, point));
    split.vertex_origin.resize(split.vertices.size(), k_none);
    result_.areas = cells_.areas;
  }

  /// A triangle, cut from the first node within a side to the corner across.
  void emit(const Triangle& corners, const std::array<Side, 3>& sides, Index cell) {
    for (int i = 0; i < 3; ++i) {
      const Side& cut = sides[i];
      if (cut.inner.empty()) continue;
      const int next = (i + 1) % 3, across = (i + 2) % 3;
      const Index node = cut.inner.front();
      const Side rest{{cut.inner.begin() + 1, cut.inner.end()}, cut.is_barrier};
      emit({corners[i], node, corners[across]}, {Side{{}, cut.is_barrier}, Side{}, sides[across]}, cell);
      emit({node, corners[next], corners[across]}, {rest, sides[next], Side{}}, cell);
      return;
    }
    result_.split.triangles.push_back(corners);
    result_.split.triangle_cell.push_back(cell);
    for (const Side& side : sides)
      result_.lines.push_back(side.is_barrier ? PartedSurface::barrier : PartedSurface::none);
  }

  const Mesh& whole_;
  const BarredMesh& barred_;
  const GeodesicVoronoi& cells_;
  const SplitMesh split_;  ///< of the barred mesh
  const SurfacePoints point_places_;
  std::vector<Index> node_;       ///< of the split mesh's vertices
  std::vector<Index> edge_from_;  ///< of the boundary: the edge on which it goes on from a vertex of the split mesh
  std::vector<Index> rank_;       ///< among the nodes of that edge
  std::vector<Edge> edges_;
  PartedSurface result_;
};

}  // namespace

PartedSurface parted_surface(const Mesh& mesh, const GeodesicVoronoi& cells) {
  PartedSurface result{cells.split(mesh), cells.points, {}, cells.areas};
  result.lines.assign(3 * result.split.triangles.size(), PartedSurface::none);
  return result;
}

PartedSurface parted_surface(const Mesh& whole, const BarredMesh& barred, const GeodesicVoronoi& cells) {
  PartedSurface result = Seam(whole, barred, cells).take();
  cut_to_barrier_ends(result);
  return result;
}

std::vector<Index> twins_of(const SplitMesh& split) {
  return twins_of(build_edge_table(split.triangles, static_cast<Index>(split.vertices.size())));
}

}  // namespace saddleback
