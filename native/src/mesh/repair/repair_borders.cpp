// Borders that nearly meet: vertices near those of another border, and vertices amid another border's edge
// (T-junctions). To a surface both are cracks, however small.

#include "mesh/repair/repair_borders.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "mesh/tables/edge_table.h"

namespace saddleback {
namespace {

/// Vertices by cells of a size; only those near a segment are looked at.
class VertexGrid {
 public:
  VertexGrid(std::span<const Vec3> positions, std::span<const Index> vertices, double cell)
      : positions_(positions), cell_(cell) {
    for (const Index v : vertices) cells_[key(cell_of(positions[v]))].push_back(v);
  }

  /// Calls visit(vertex) for those whose cell the segment, widened by `reach`, may meet; some more than once.
  template <class Visit>
  void near_segment(const Vec3& a, const Vec3& b, double reach, Visit&& visit) const {
    const Cell low = cell_of(a.cwiseMin(b).array() - reach), high = cell_of(a.cwiseMax(b).array() + reach);
    std::int64_t count = 1;
    for (int i = 0; i < 3; ++i) count *= std::min<std::int64_t>(high[i] - low[i] + 1, k_few + 1);
    if (count > k_few && (b - a).norm() > cell_) {  // a long diagonal one: its halves meet fewer
      const Vec3 middle = (a + b) / 2;
      near_segment(a, middle, reach, visit);
      near_segment(middle, b, reach, visit);
      return;
    }
    for (std::int64_t i = low[0]; i <= high[0]; ++i)
      for (std::int64_t j = low[1]; j <= high[1]; ++j)
        for (std::int64_t k = low[2]; k <= high[2]; ++k)
          if (const auto found = cells_.find(key({i, j, k})); found != cells_.end())
            for (const Index v : found->second) visit(v);
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  static constexpr std::int64_t k_few = 27;

  Cell cell_of(const Vec3& p) const {
    Cell cell;
    for (int i = 0; i < 3; ++i) cell[i] = std::llround(std::clamp(p[i] / cell_, -1e17, 1e17));
    return cell;
  }
  /// Cells that share a key only make the search longer.
  static std::uint64_t key(const Cell& cell) {
    std::uint64_t hash = 0;
    for (const std::int64_t x : cell) hash = (hash ^ static_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15u;
    return hash ^ (hash >> 29);
  }

  std::span<const Vec3> positions_;
  double cell_;
  std::unordered_map<std::uint64_t, std::vector<Index>> cells_;
};

std::vector<Index> border_halfedges(std::span<const Triangle> triangles, Index vertex_count, const JobStage& stage) {
  const EdgeTable edges = build_edge_table(triangles, vertex_count, stage);
  std::vector<Index> border;
  for (Index e = 0; e < edges.edge_count(); ++e)
    if (edges.edge(e).size() == 1) border.push_back(edges.edge(e)[0]);
  return border;
}

}  // namespace

std::vector<BorderContact> border_contacts(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                           const Reach& reach, const JobStage& stage) {
  const std::vector<Index> border = border_halfedges(triangles, static_cast<Index>(positions.size()), stage);
  std::vector<Index> vertices;
  double total = 0;
  for (const Index h : border) {
    const Index a = halfedge_from(triangles, h), b = halfedge_to(triangles, h);
    vertices.insert(vertices.end(), {a, b});
    total += (positions[b] - positions[a]).norm();
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  if (border.empty() || !(total > 0)) return {};
  constexpr double k_edges_a_cell = 2;
  const VertexGrid grid(positions, vertices, k_edges_a_cell * total / static_cast<double>(border.size()));
  std::vector<BorderContact> contacts;
  std::int64_t visits = reach.most_visits;
  for (const Index h : border) {
    stage.check();
    if (visits < 0) break;
    const Index a = halfedge_from(triangles, h), b = halfedge_to(triangles, h), apex = halfedge_apex(triangles, h);
    const Vec3 side = positions[b] - positions[a];
    const double length = side.norm(), most = std::max(reach.distance, reach.share * length);
    if (!(length > 0)) continue;
    const std::size_t first = contacts.size();
    grid.near_segment(positions[a], positions[b], most, [&](Index v) {
      --visits;
      if (v == a || v == b || v == apex) return;
      const double along = std::clamp((positions[v] - positions[a]).dot(side) / (length * length), 0.0, 1.0);
      const double distance = (positions[v] - positions[a] - along * side).norm();
      if (distance > most) return;
      const double to_end = std::min((positions[v] - positions[a]).norm(), (positions[v] - positions[b]).norm());
      contacts.push_back({v, h, along, distance, to_end <= most ? to_end : -1});
    });
    // The halves of a long edge may have met a cell twice.
    const auto begin = contacts.begin() + static_cast<std::ptrdiff_t>(first);
    std::sort(begin, contacts.end(), [](const BorderContact& p, const BorderContact& q) {
      return p.along != q.along ? p.along < q.along : p.vertex < q.vertex;
    });
    contacts.erase(std::unique(begin, contacts.end(),
                               [](const BorderContact& p, const BorderContact& q) { return p.vertex == q.vertex; }),
                   contacts.end());
  }
  return contacts;
}

void stitch_borders(RepairState& state, double weld_distance, const JobStage& stage) {
  constexpr double k_on_the_edge = 1e-9;  // of the edge's length: what rounding leaves of a vertex meant to be on it
  for (bool found = true; found;) {       // a face may have several such edges: one in each pass
    found = false;
    const std::vector<Index> faces = state.live_faces();
    std::vector<Triangle> triangles;
    for (const Index f : faces) {
      const Triangle& t = state.triangles[f];
      triangles.push_back({state.cluster[t[0]], state.cluster[t[1]], state.cluster[t[2]]});
    }
    std::vector<std::uint8_t> is_divided(faces.size(), 0);
    const std::vector<BorderContact> contacts =
        border_contacts(state.positions, triangles, {weld_distance, k_on_the_edge}, stage);
    for (std::size_t i = 0, end = 0; i < contacts.size(); i = end) {
      const Index h = contacts[i].halfedge;
      std::vector<Index> amid;
      for (; end < contacts.size() && contacts[end].halfedge == h; ++end)
        if (contacts[end].to_end < 0) amid.push_back(contacts[end].vertex);
      if (amid.empty() || is_divided[h / 3]) continue;
      is_divided[h / 3] = 1;
      found = true;
      divide_edge(state, faces[h / 3], h % 3, amid);
    }
  }
}

void divide_edge(RepairState& state, Index face, int side, std::span<const Index> amid) {
  const Triangle t = state.triangles[face];
  const Index from = t[side], to = t[(side + 1) % 3], apex = t[(side + 2) % 3];
  state.triangles[face] = {from, amid.front(), apex};
  for (std::size_t i = 0; i < amid.size(); ++i) state.add_face({amid[i], i + 1 < amid.size() ? amid[i + 1] : to, apex});
  state.count("edges_stitched");
}

CloseBorders tell_close_borders(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                const JobStage& stage) {
  // Nearer than this share of an edge nothing is modeled; a border that near another was meant to meet it.
  constexpr double k_surely_meant = 1e-4;
  constexpr std::int64_t k_looks_a_face = 50, k_looks_always = 1'000'000;
  // Looks that are taken at most: where thousands of vertices crowd one place, some of them say as much as all.
  const std::int64_t most_visits = k_looks_a_face * std::ssize(triangles) + k_looks_always;
  // Copies at one place were made on purpose, by a repair: they count as one.
  const std::vector<std::uint8_t> all(positions.size(), 1);
  const std::vector<Index> place = weld_clusters(positions, all, 0, stage);
  std::vector<Triangle> placed;
  placed.reserve(triangles.size());
  for (const Triangle& t : triangles) placed.push_back({place[t[0]], place[t[1]], place[t[2]]});
  CloseBorders close;
  std::vector<Index> near, amid;
  for (const BorderContact& contact : border_contacts(positions, placed, {0, k_surely_meant, most_visits}, stage)) {
    if (contact.to_end < 0) {
      amid.push_back(contact.vertex);
    } else {
      near.push_back(contact.vertex);
      close.weld_distance = std::max(close.weld_distance, contact.to_end);
    }
  }
  const auto distinct = [](std::vector<Index>& vertices) {
    std::sort(vertices.begin(), vertices.end());
    return static_cast<Index>(std::unique(vertices.begin(), vertices.end()) - vertices.begin());
  };
  close.near_vertices = distinct(near);
  close.vertices_amid_edges = distinct(amid);
  // Two digits say as much as is known, and a little more than the gap joins it.
  if (close.weld_distance > 0) {
    const double unit = std::pow(10.0, std::floor(std::log10(close.weld_distance)) - 1);
    close.weld_distance = (std::floor(close.weld_distance / unit) + 1) * unit;
  }
  return close;
}

}  // namespace saddleback
