#include "tessellation/cells/cell_topology.h"

#include <algorithm>
#include <map>

#include "saddleback/mesh/surface_curve.h"

#include "tessellation/cells/border_arcs.h"

namespace saddleback {
namespace {

Index polyline_count(const GeodesicVoronoi& cells) { return static_cast<Index>(cells.edge_cells.size()); }
Index first_point(const GeodesicVoronoi& cells, Index polyline) {
  return cells.edge_points[cells.edge_offsets[polyline]];
}
Index last_point(const GeodesicVoronoi& cells, Index polyline) {
  return cells.edge_points[cells.edge_offsets[polyline + 1] - 1];
}
SurfacePoint middle(const GeodesicVoronoi& cells, Index polyline) {
  const Index begin = cells.edge_offsets[polyline], end = cells.edge_offsets[polyline + 1];
  return cells.points[cells.edge_points[begin + (end - begin) / 2]];
}

/// Twice the edges of each cell: an edge inside a cell is met from both sides; one on its border from one, and counts
/// once more. Faces and pieces may be divided inside a cell, too.
void count_edges(const Mesh& mesh, const GeodesicVoronoi& cells, std::vector<Index>& twice) {
  const auto is_border = [&](Index face, int side) { return mesh.twin(3 * face + side) == k_none; };
  for (Index face = 0; face < mesh.face_count(); ++face) {
    if (cells.face_cell[face] == k_none) continue;
    for (int side = 0; side < 3; ++side) twice[cells.face_cell[face]] += is_border(face, side) ? 2 : 1;
  }
  for (const GeodesicVoronoi::Piece& piece : cells.pieces) {
    twice[piece.cell] += piece.count;
    for (int side = 0; side < 3; ++side) {
      if (!is_border(piece.face, side)) continue;
      const auto is_on_side = [&](Index i) { return cells.piece_barycentric[piece.first + i][(side + 2) % 3] == 0; };
      for (Index i = 0; i < piece.count; ++i)
        if (is_on_side(i) && is_on_side((i + 1) % piece.count)) ++twice[piece.cell];
    }
  }
  for (Index polyline = 0; polyline < polyline_count(cells); ++polyline)
    for (const Index cell : cells.edge_cells[polyline])
      twice[cell] += cells.edge_offsets[polyline + 1] - cells.edge_offsets[polyline] - 1;
}

/// Vertices inside cells, of the mesh and where its faces are divided, and, on the cells' borders, a vertex for each
/// stretch of a cell around a point.
void count_vertices(const Mesh& mesh, const GeodesicVoronoi& cells, const PointStars& stars,
                    std::vector<Index>& count) {
  std::vector<Index> cell_of(mesh.vertex_count() + cells.points.size(), k_none);
  for (Index face = 0; face < mesh.face_count(); ++face) {
    if (cells.face_cell[face] == k_none) continue;
    for (const Index v : mesh.triangles()[face]) cell_of[v] = cells.face_cell[face];
  }
  for (const GeodesicVoronoi::Piece& piece : cells.pieces)
    for (Index i = piece.first; i < piece.first + piece.count; ++i) cell_of[cells.piece_vertices[i]] = piece.cell;
  for (const Index point : cells.edge_points) cell_of[mesh.vertex_count() + point] = k_none;
  for (const Index cell : cell_of)
    if (cell != k_none) ++count[cell];
  for (Index polyline = 0; polyline < polyline_count(cells); ++polyline) {
    const Index points = cells.edge_offsets[polyline + 1] - cells.edge_offsets[polyline];
    const Index inner = cells.edge_closed[polyline] ? points - 1 : points - 2;
    for (const Index cell : cells.edge_cells[polyline]) count[cell] += inner;
  }
  for (Index point = 0; point < static_cast<Index>(cells.points.size()); ++point) {
    const auto rays = stars.rays(point);
    for (const PointStars::Ray& ray : rays) {
      ++count[ray.left];
      // At the mesh's boundary the stretch right of the first ray has no ray before it.
      const auto before = [&](const PointStars::Ray& other) { return other.left == ray.right; };
      if (std::none_of(rays.begin(), rays.end(), before)) ++count[ray.right];
    }
  }
}

class IssueFinder {
 public:
  IssueFinder(const Mesh& mesh, const GeodesicVoronoi& cells, const JobStage& stage)
      : mesh_(mesh), cells_(cells), stars_(cells), characteristic_(cell_characteristics(mesh, cells)) {
    for (const auto step :
         {&IssueFinder::find_far_places, &IssueFinder::look_at_cells, &IssueFinder::look_at_boundaries,
          &IssueFinder::look_at_branch_points, &IssueFinder::look_at_corners}) {
      stage.check();
      (this->*step)();
    }
  }
  std::vector<DualIssue> take() { return std::move(issues_); }

 private:
  using Kind = DualIssue::Kind;
  void add(Kind kind, Index cell, Index other, const SurfacePoint& place) {
    issues_.push_back({kind, cell, other, place});
  }

  /// The farthest vertex or border point of every cell.
  void find_far_places() {
    far_.resize(cells_.sites.size());
    std::vector<double> farthest(cells_.sites.size(), -1);
    const auto offer = [&](Index cell, double distance, const SurfacePoint& place) {
      if (distance > farthest[cell]) farthest[cell] = distance, far_[cell] = place;
    };
    for (Index v = 0; v < mesh_.vertex_count(); ++v) {
      if (cells_.vertex_distance[v] > farthest[cells_.vertex_cell[v]]) {
        offer(cells_.vertex_cell[v], cells_.vertex_distance[v], at_vertex(mesh_, v));
      }
    }
    for (Index polyline = 0; polyline < polyline_count(cells_); ++polyline) {
      for (Index i = cells_.edge_offsets[polyline]; i < cells_.edge_offsets[polyline + 1]; ++i) {
        const Index point = cells_.edge_points[i];
        for (const Index cell : cells_.edge_cells[polyline]) {
          offer(cell, cells_.point_distance[point], cells_.points[point]);
        }
      }
    }
  }

  void look_at_cells() {
    std::vector<Index> arcs(cells_.sites.size(), 0);  // at the mesh's boundary: ends on it, two an arc
    for (Index point = 0; point < static_cast<Index>(cells_.points.size()); ++point) {
      const auto rays = stars_.rays(point);
      if (rays.size() != 1) continue;
      ++arcs[rays[0].left];
      ++arcs[rays[0].right];
    }
    const std::vector<std::optional<SurfacePoint>> on_border = places_on_borders(mesh_, cells_, stars_);
    for (Index cell = 0; cell < static_cast<Index>(cells_.sites.size()); ++cell) {
      if (cells_.areas[cell] == 0) continue;  // coincides with another site
      if (characteristic_[cell] != 1)
        add(Kind::not_a_disk, cell, k_none, on_border[cell].value_or(far_[cell]));
      else if (arcs[cell] > 2)
        add(Kind::two_borders, cell, k_none, on_border[cell].value_or(far_[cell]));
    }
  }

  void look_at_boundaries() {
    std::map<std::pair<Index, Index>, Index> nearest;  // the polyline through which two sites are nearest
    std::vector<double> least(polyline_count(cells_));
    for (Index polyline = 0; polyline < polyline_count(cells_); ++polyline) {
      const auto [a, b] = std::minmax(cells_.edge_cells[polyline][0], cells_.edge_cells[polyline][1]);
      if (cells_.edge_closed[polyline]) {
        add(Kind::closed_boundary, a, b, middle(cells_, polyline));
        continue;
      }
      least[polyline] = std::numeric_limits<double>::infinity();
      for (Index i = cells_.edge_offsets[polyline]; i < cells_.edge_offsets[polyline + 1]; ++i) {
        least[polyline] = std::min(least[polyline], cells_.point_distance[cells_.edge_points[i]]);
      }
      const auto [known, is_new] = nearest.try_emplace({a, b}, polyline);
      if (is_new) continue;
      const Index farther = least[polyline] < least[known->second] ? known->second : polyline;
      if (farther == known->second) known->second = polyline;
      add(Kind::double_boundary, a, b, middle(cells_, farther));
    }
  }

  void look_at_branch_points() {
    for (const Index point : cells_.branch_points) {
      std::vector<Index> around = cells_around(stars_, point);
      std::sort(around.begin(), around.end());
      const auto twice = std::adjacent_find(around.begin(), around.end());
      if (twice != around.end()) add(Kind::cell_meets_itself, *twice, k_none, far_[*twice]);
    }
  }

  /// A cell needs three corners to have a triangle; ends at the mesh's boundary are some. A cell without any is
  /// reported by what else is wrong, but for one that has all of a disk.
  void look_at_corners() {
    std::vector<Index> corners(cells_.sites.size(), 0);
    std::vector<std::uint8_t> has_border(cells_.sites.size(), 0);
    for (const auto& sides : cells_.edge_cells)
      for (const Index cell : sides) has_border[cell] = 1;
    for (Index point = 0; point < static_cast<Index>(cells_.points.size()); ++point) {
      const auto rays = stars_.rays(point);
      for (const PointStars::Ray& ray : rays) ++corners[ray.left];
      if (rays.size() == 1) ++corners[rays[0].right];
    }
    for (Index cell = 0; cell < static_cast<Index>(cells_.sites.size()); ++cell) {
      const bool has_all = !has_border[cell] && cells_.areas[cell] > 0 && characteristic_[cell] == 1;
      if (has_all || (corners[cell] > 0 && corners[cell] < 3)) add(Kind::few_corners, cell, k_none, far_[cell]);
    }
  }

  const Mesh& mesh_;
  const GeodesicVoronoi& cells_;
  const PointStars stars_;
  const std::vector<Index> characteristic_;
  SurfacePoints far_;
  std::vector<DualIssue> issues_;
};

}  // namespace

PointStars::PointStars(const GeodesicVoronoi& cells) : first_(cells.points.size() + 1, 0) {
  for (Index polyline = 0; polyline < polyline_count(cells); ++polyline) {
    if (cells.edge_closed[polyline]) continue;
    ++first_[first_point(cells, polyline) + 1];
    ++first_[last_point(cells, polyline) + 1];
  }
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  rays_.resize(first_.back());
  std::vector<Index> cursor(first_.begin(), first_.end() - 1);
  for (Index polyline = 0; polyline < polyline_count(cells); ++polyline) {
    if (cells.edge_closed[polyline]) continue;
    const auto [left, right] = cells.edge_cells[polyline];
    rays_[cursor[first_point(cells, polyline)]++] = {polyline, true, left, right};
    rays_[cursor[last_point(cells, polyline)]++] = {polyline, false, right, left};
  }
}

std::vector<Index> cells_around(const PointStars& stars, Index branch_point) {
  const auto rays = stars.rays(branch_point);
  std::vector<std::uint8_t> used(rays.size(), 0);
  std::vector<Index> around;
  std::size_t at = 0;
  while (at < rays.size()) {
    used[at] = 1;
    around.push_back(rays[at].left);
    // The next ray counter-clockwise has this one's left cell on its right.
    std::size_t next = 0;
    while (next < rays.size() && (used[next] || rays[next].right != rays[at].left)) ++next;
    at = next;
  }
  return around;
}

std::vector<Index> cell_characteristics(const Mesh& mesh, const GeodesicVoronoi& cells) {
  std::vector<Index> vertices(cells.sites.size(), 0), twice_edges(cells.sites.size(), 0), faces(cells.sites.size(), 0);
  for (const Index cell : cells.face_cell) {
    if (cell != k_none) ++faces[cell];
  }
  for (const GeodesicVoronoi::Piece& piece : cells.pieces) ++faces[piece.cell];
  count_edges(mesh, cells, twice_edges);
  count_vertices(mesh, cells, PointStars(cells), vertices);
  std::vector<Index> result(cells.sites.size());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = vertices[i] - twice_edges[i] / 2 + faces[i];
  return result;
}

std::vector<DualIssue> find_dual_issues(const Mesh& mesh, const GeodesicVoronoi& cells, const JobStage& stage) {
  return IssueFinder(mesh, cells, stage).take();
}

SurfacePoint point_along(const Mesh& mesh, const GeodesicVoronoi& cells, Index polyline, double share) {
  const Index begin = cells.edge_offsets[polyline], end = cells.edge_offsets[polyline + 1];
  const auto length = [&](Index i) {
    return (cells.positions[cells.edge_points[i + 1]] - cells.positions[cells.edge_points[i]]).norm();
  };
  double left = 0;
  for (Index i = begin; i + 1 < end; ++i) left += share * length(i);
  Index i = begin;
  while (i + 2 < end && left > length(i)) left -= length(i++);
  const SurfacePoint &a = cells.points[cells.edge_points[i]], &b = cells.points[cells.edge_points[i + 1]];
  const Index face = shared_face(mesh, a, b);
  if (face == k_none) return a;
  const double part = length(i) > 0 ? std::clamp(left / length(i), 0.0, 1.0) : 0;
  const Vec3 place = (1 - part) * *barycentric_in(mesh, a, face) + part * *barycentric_in(mesh, b, face);
  return {face, normalized_barycentric(place)};
}

std::vector<PlaceToMend> places_to_mend(const Mesh& mesh, const GeodesicVoronoi& cells,
                                        const std::vector<DualIssue>& issues) {
  std::vector<std::uint8_t> mended(cells.sites.size(), 0);
  const auto is_new = [&](Index cell, Index other) {
    if (mended[cell] || (other != k_none && mended[other])) return false;
    mended[cell] = 1;
    if (other != k_none) mended[other] = 1;
    return true;
  };
  std::vector<PlaceToMend> places;
  for (Index polyline = 0; polyline < polyline_count(cells); ++polyline)
    if (cells.edge_closed[polyline] && is_new(cells.edge_cells[polyline][0], cells.edge_cells[polyline][1]))
      for (int third = 0; third < 3; ++third) places.push_back({point_along(mesh, cells, polyline, third / 3.0), true});
  for (const DualIssue& issue : issues)
    if (is_new(issue.cell, issue.other)) places.push_back({issue.place, false});
  return places;
}

bool is_on_boundary(const Mesh& mesh, const SurfacePoint& place) {
  if (const Index vertex = vertex_at(mesh, place); vertex != k_none) return mesh.is_boundary(vertex);
  for (int side = 0; side < 3; ++side)
    if (mesh.twin(3 * place.face + side) == k_none && place.barycentric[(side + 2) % 3] == 0) return true;
  return false;
}

}  // namespace saddleback
