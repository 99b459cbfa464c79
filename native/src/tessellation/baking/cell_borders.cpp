#include "tessellation/baking/cell_borders.h"

#include <algorithm>
#include <numeric>

#include "saddleback/mesh/surface_curve.h"

namespace saddleback {
namespace {

double length_of(const Mesh& mesh, const GeodesicVoronoi& cells, Index edge) {
  double length = 0;
  for (Index i = cells.edge_offsets[edge] + 1; i < cells.edge_offsets[edge + 1]; ++i)
    length += step_length(mesh, cells.points[cells.edge_points[i - 1]], cells.points[cells.edge_points[i]]);
  return length;
}

}  // namespace

CellBorders::CellBorders(const Mesh& mesh, const GeodesicVoronoi& cells, const JobStage& stage)
    : first_(cells.areas.size() + 1, 0) {
  const auto edge_count = static_cast<Index>(cells.edge_cells.size());
  // Ends of boundaries without length are one point.
  std::vector<Index> same(cells.points.size());
  std::iota(same.begin(), same.end(), 0);
  const auto one_of = [&](Index point) {
    while (same[point] != point) point = same[point];
    return point;
  };
  std::vector<Index> kept;
  for (Index edge = 0; edge < edge_count; ++edge) {
    if (length_of(mesh, cells, edge) > 0) {
      kept.push_back(edge);
    } else {
      same[one_of(cells.edge_points[cells.edge_offsets[edge + 1] - 1])] =
          one_of(cells.edge_points[cells.edge_offsets[edge]]);
    }
  }
  curves_.reserve(kept.size());
  std::vector<BorderPart> parts;
  std::vector<std::pair<Index, std::size_t>> by_cell;
  for (const Index edge : kept) {
    stage.check();
    SurfacePoints points;
    const bool is_closed = cells.edge_closed[edge] != 0;
    const Index begin = cells.edge_offsets[edge], end = cells.edge_offsets[edge + 1];
    for (Index i = begin; i < end - (is_closed ? 1 : 0); ++i) points.push_back(cells.points[cells.edge_points[i]]);
    curves_.emplace_back(mesh, std::move(points), is_closed);
    Index from = k_none, to = k_none;
    if (!is_closed) from = one_of(cells.edge_points[begin]), to = one_of(cells.edge_points[end - 1]);
    for (const int side : {0, 1}) by_cell.emplace_back(cells.edge_cells[edge][side], parts.size() + side);
    parts.push_back({&curves_.back(), 1, from, to});
    parts.push_back({&curves_.back(), -1, to, from});
  }
  std::ranges::sort(by_cell);
  for (const auto& [cell, number] : by_cell) {
    parts_.push_back(parts[number]);
    ++first_[cell + 1];
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
}

std::vector<double> reaches_of(const Mesh& mesh, const GeodesicVoronoi& cells) {
  std::vector<double> reach(cells.areas.size(), 0);
  const auto note = [&](Index cell, double distance) { reach[cell] = std::max(reach[cell], distance); };
  for (Index face = 0; face < mesh.face_count(); ++face) {
    if (cells.face_cell[face] == k_none) continue;
    for (const Index vertex : mesh.triangles()[face]) note(cells.face_cell[face], cells.vertex_distance[vertex]);
  }
  for (const GeodesicVoronoi::Piece& piece : cells.pieces) {
    for (Index i = piece.first; i < piece.first + piece.count; ++i) {
      const Index corner = cells.piece_vertices[i], point = corner - mesh.vertex_count();
      note(piece.cell, point < 0 ? cells.vertex_distance[corner] : cells.point_distance[point]);
    }
  }
  return reach;
}

}  // namespace saddleback
