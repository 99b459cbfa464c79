#include <algorithm>
#include <cmath>
#include <limits>

#include "saddleback/error.h"
#include "saddleback/mesh/triangle_arrays.h"

#include "mesh/tables/corner_table.h"

namespace saddleback {
namespace {

void check_cells(std::span<const Triangle> triangles, std::span<const Index> triangle_cell) {
  if (triangle_cell.size() == triangles.size()) return;
  throw InputError(message("triangle_cell: wanted one cell for each of the ", triangles.size(), " triangles, got ",
                           triangle_cell.size()));
}

CellBoundary find_boundary(const CornerTable& table, std::span<const Index> triangle_cell) {
  CellBoundary result;
  for (Index vertex = 0; vertex < table.vertex_count(); ++vertex) {
    const auto corners = table.at(vertex);
    const auto cell_of = [&](const CornerTable::Corner& corner) { return triangle_cell[corner.triangle]; };
    const auto is_first = [&](const CornerTable::Corner& corner) { return cell_of(corner) == cell_of(corners[0]); };
    if (std::ranges::all_of(corners, is_first)) continue;
    const SharedEdges shared(corners);
    for (const CornerTable::Corner& corner : corners) {
      shared.any(corner, [&](const CornerTable::Corner& other) {
        // Edges are met from both ends and by both triangles: once is enough.
        const bool is_met_again =
            other.previous == corner.next ? vertex > corner.next : other.triangle < corner.triangle;
        if (cell_of(corner) == cell_of(other) || is_met_again) return false;
        result.segments.push_back({vertex, corner.next});
        result.cells.push_back({cell_of(corner), cell_of(other)});
        return false;
      });
    }
  }
  return result;
}

double squared_distance_to(const Vec3& point, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a, to_point = point - a;
  const double squared_length = along.squaredNorm();
  const double share = squared_length > 0 ? std::clamp(to_point.dot(along) / squared_length, 0.0, 1.0) : 0;
  return (to_point - share * along).squaredNorm();
}

/// The nearest segment found so far for each vertex.
class BoundarySearch {
 public:
  BoundarySearch(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                 std::span<const Index> triangle_cell)
      : vertices_(vertices),
        table_(triangles, static_cast<Index>(vertices.size())),
        boundary_(find_boundary(table_, triangle_cell)),
        cells_(vertices.size(), k_none),
        nearest_(vertices.size(), k_none),
        squared_(vertices.size(), std::numeric_limits<double>::infinity()),
        first_(vertices.size() + 1, 0),
        at_(2 * boundary_.segments.size()) {
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (const Index v : triangles[t]) cells_[v] = triangle_cell[t];
    for (const auto& ends : boundary_.segments)
      for (const Index v : ends) ++first_[v + 1], squared_[v] = 0;
    for (std::size_t v = 0; v < vertices.size(); ++v) first_[v + 1] += first_[v];
    std::vector<Index> cursor(first_.begin(), first_.end() - 1);
    for (Index i = 0; i < static_cast<Index>(boundary_.segments.size()); ++i)
      for (const Index v : boundary_.segments[i]) at_[cursor[v]++] = i;
  }

  /// Ring after ring, from the vertices beside the boundary on.
  void spread(double limit) {
    std::vector<Index> ring, next;
    std::vector<std::uint8_t> waits(vertices_.size(), 0);
    const auto reach = [&](Index vertex) {
      follow_boundary(vertex);
      if (!waits[vertex]) next.push_back(vertex);
      waits[vertex] = 1;
    };
    for (Index v = 0; v < static_cast<Index>(vertices_.size()); ++v)
      if (offer_neighbors_segments(v)) reach(v);
    while (!next.empty()) {
      ring.swap(next);
      next.clear();
      for (const Index v : ring) waits[v] = 0;
      for (const Index v : ring) {
        if (squared_[v] < limit * limit)
          visit_neighbors(v, [&](Index w) {
            if (!touches(w) && nearest_[w] != nearest_[v] && offer(w, nearest_[v])) reach(w);
          });
      }
    }
  }

  std::vector<double> distances() {
    for (double& value : squared_) value = std::sqrt(value);
    return std::move(squared_);
  }

 private:
  bool touches(Index vertex) const { return first_[vertex] < first_[vertex + 1]; }

  template <class Visit>
  void visit_neighbors(Index vertex, Visit&& visit) const {
    for (const CornerTable::Corner& corner : table_.at(vertex)) {
      visit(corner.next);
      visit(corner.previous);
    }
  }

  bool offer(Index vertex, Index segment) {
    const auto& [a, b] = boundary_.segments[segment];
    const double found = squared_distance_to(vertices_[vertex], vertices_[a], vertices_[b]);
    if (!(found < squared_[vertex])) return false;
    squared_[vertex] = found;
    nearest_[vertex] = segment;
    return true;
  }

  /// The segments at a vertex of the boundary that bound the other's own cell.
  bool offer_segments_at(Index vertex, Index on_boundary) {
    bool nearer = false;
    for (Index i = first_[on_boundary]; i < first_[on_boundary + 1]; ++i) {
      const auto& [left, right] = boundary_.cells[at_[i]];
      if (left == cells_[vertex] || right == cells_[vertex]) nearer = offer(vertex, at_[i]) || nearer;
    }
    return nearer;
  }

  bool offer_neighbors_segments(Index vertex) {
    if (touches(vertex)) return false;
    bool nearer = false;
    visit_neighbors(vertex, [&](Index w) { nearer = offer_segments_at(vertex, w) || nearer; });
    return nearer;
  }

  /// Follows it along the boundary from the segment found, as long as that comes nearer.
  void follow_boundary(Index vertex) {
    for (Index before = k_none; before != nearest_[vertex];) {
      before = nearest_[vertex];
      for (const Index end : boundary_.segments[before]) offer_segments_at(vertex, end);
    }
  }

  std::span<const Vec3> vertices_;
  const CornerTable table_;
  const CellBoundary boundary_;
  std::vector<Index> cells_, nearest_;
  std::vector<double> squared_;
  std::vector<Index> first_, at_;  ///< segments at each vertex
};

}  // namespace

CellBoundary cell_boundary(std::span<const Triangle> triangles, std::span<const Index> triangle_cell,
                           Index vertex_count) {
  check_cells(triangles, triangle_cell);
  return find_boundary(CornerTable(triangles, vertex_count), triangle_cell);
}

std::vector<double> cell_boundary_distance(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                                           std::span<const Index> triangle_cell, double limit) {
  check_cells(triangles, triangle_cell);
  BoundarySearch search(vertices, triangles, triangle_cell);
  search.spread(limit);
  return search.distances();
}

}  // namespace saddleback
