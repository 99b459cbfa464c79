#include "tessellation/cells/border_arcs.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

namespace saddleback {
namespace {

/// A stop on the way along a boundary loop: one of its vertices, or an end of a boundary between cells.
struct Stop {
  Index vertex = k_none, point = k_none;
};

class Walk {
 public:
  Walk(const Mesh& mesh, const GeodesicVoronoi& cells, const PointStars& stars)
      : mesh_(mesh), cells_(cells), stars_(stars), ends_(mesh.halfedge_count()), out_of_(mesh.vertex_count(), k_none) {
    for (Index h = 0; h < mesh.halfedge_count(); ++h)
      if (mesh.twin(h) == k_none) out_of_[origin(h)] = h;
    for (Index point = 0; point < static_cast<Index>(cells.points.size()); ++point)
      if (stars.rays(point).size() == 1) add_end(point);
    for (std::vector<Index>& ends : ends_)
      std::ranges::sort(ends, {}, [&](Index point) { return std::pair(along(point), point); });
  }

  std::vector<BorderArc> arcs() {
    std::vector<BorderArc> result;
    for (Index v = 0; v < mesh_.vertex_count(); ++v) {
      const std::vector<Stop> loop = loop_from(v);
      if (!loop.empty()) cut(loop, result);
    }
    return result;
  }

 private:
  Index origin(Index h) const { return mesh_.triangles()[Mesh::face_of(h)][h % 3]; }
  double along(Index point) const {
    const SurfacePoint& place = cells_.points[point];
    for (int side = 0; side < 3; ++side)
      if (is_on(place, side)) return place.barycentric[(side + 1) % 3];
    return 0;
  }
  bool is_on(const SurfacePoint& place, int side) const {
    return mesh_.twin(3 * place.face + side) == k_none && place.barycentric[(side + 2) % 3] == 0;
  }
  void add_end(Index point) {
    const SurfacePoint& place = cells_.points[point];
    for (int side = 0; side < 3; ++side) {
      if (!is_on(place, side)) continue;
      ends_[3 * place.face + side].push_back(point);
      return;
    }
  }

  /// The loop through a vertex, once.
  std::vector<Stop> loop_from(Index vertex) {
    std::vector<Stop> stops;
    while (out_of_[vertex] != k_none) {
      const Index h = std::exchange(out_of_[vertex], k_none);
      stops.push_back({vertex, k_none});
      for (const Index point : ends_[h]) stops.push_back({k_none, point});
      vertex = origin(3 * Mesh::face_of(h) + (h + 1) % 3);
    }
    return stops;
  }

  /// The face lies on the left of the way, so that a boundary between cells has on its right, seen from its end here,
  /// the cell that comes next.
  void cut(std::vector<Stop> stops, std::vector<BorderArc>& result) const {
    const auto first = std::ranges::find_if(stops, [](const Stop& stop) { return stop.point != k_none; });
    if (first == stops.end()) {
      BorderArc arc = arc_of(cells_.vertex_cell[stops[0].vertex], stops.begin(), stops.end());
      arc.is_loop = true;
      result.push_back(arc);
      return;
    }
    std::rotate(stops.begin(), first, stops.end());
    stops.push_back(stops.front());
    for (auto begin = stops.begin(); begin + 1 != stops.end();) {
      const auto end = std::find_if(begin + 1, stops.end(), [](const Stop& stop) { return stop.point != k_none; });
      const Index cell = stars_.rays(begin->point)[0].right;
      if (end == begin + 1)
        result.push_back(short_arc(cell, begin->point, end->point));
      else
        result.push_back(arc_of(cell, begin + 1, end));
      begin = end;
    }
  }

  BorderArc arc_of(Index cell, std::vector<Stop>::const_iterator begin, std::vector<Stop>::const_iterator end) const {
    BorderArc arc;
    arc.cell = cell;
    arc.least = std::numeric_limits<double>::infinity();
    double most = -1;
    for (auto stop = begin; stop != end; ++stop) {
      const double distance = cells_.vertex_distance[stop->vertex];
      if (distance < arc.least) arc.least = distance, arc.nearest = at_vertex(mesh_, stop->vertex);
      if (distance > most) most = distance, arc.far = at_vertex(mesh_, stop->vertex);
    }
    return arc;
  }

  /// Returns the arc between two ends on one edge.
  BorderArc short_arc(Index cell, Index a, Index b) const {
    const SurfacePoint &begin = cells_.points[a], &end = cells_.points[b];
    const SurfacePoint middle{begin.face, normalized_barycentric(0.5 * (begin.barycentric + end.barycentric))};
    const double least = std::min(cells_.point_distance[a], cells_.point_distance[b]);
    return {.cell = cell, .is_loop = false, .least = least, .nearest = middle, .far = middle};
  }

  const Mesh& mesh_;
  const GeodesicVoronoi& cells_;
  const PointStars& stars_;
  std::vector<std::vector<Index>> ends_;  ///< by half-edge, in its direction
  std::vector<Index> out_of_;             ///< by vertex, the half-edge along the boundary, until it is walked
};

}  // namespace

std::vector<BorderArc> border_arcs(const Mesh& mesh, const GeodesicVoronoi& cells, const PointStars& stars) {
  if (mesh.boundary_loops().empty()) return {};
  return Walk(mesh, cells, stars).arcs();
}

std::vector<std::optional<SurfacePoint>> places_on_borders(const Mesh& mesh, const GeodesicVoronoi& cells,
                                                           const PointStars& stars) {
  std::vector<BorderArc> arcs = border_arcs(mesh, cells, stars);
  std::ranges::stable_sort(arcs, {},
                           [](const BorderArc& arc) { return std::tuple(arc.cell, !arc.is_loop, arc.least); });
  std::vector<std::optional<SurfacePoint>> places(cells.sites.size());
  for (std::size_t i = 0; i < arcs.size(); ++i) {
    std::optional<SurfacePoint>& place = places[arcs[i].cell];
    const bool is_first = i == 0 || arcs[i - 1].cell != arcs[i].cell;
    if (place) continue;
    if (arcs[i].is_loop)
      place = arcs[i].far;
    else if (!is_first)
      place = arcs[i].nearest;
  }
  return places;
}

}  // namespace saddleback
