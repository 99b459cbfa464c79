#include "tessellation/baking/texels_of_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saddleback/geodesics/log_map.h"
#include "saddleback/mesh/trace.h"

#include "geodesics/wavefront/log_about.h"

namespace saddleback {
namespace {

// The cells' own distances are those of a graph: as much longer or shorter than the surface's, at first.
constexpr double k_first_reach = 1.02, k_next_reach = 1.5;
constexpr double k_first_edge = 0.01;    ///< more than nothing
constexpr std::size_t k_checked = 4096;  ///< texels, some 0.2 ms

struct Way {
  double length;
  double label;
};

/// The shorter of the way that rays have found and those by a corner of the face.
Way way_to(const WavefrontDistances& field, const Mesh& mesh, const FaceChart& chart, const SurfacePoint& place,
           std::size_t i, const Vec2& at) {
  Way way{field.places().values()[i], field.places().labels()[i]};
  for (int corner = 0; corner < 3; ++corner) {
    const Index vertex = mesh.triangles()[place.face][corner];
    if (!(field.distance(vertex) < way.length)) continue;
    const double by_corner = field.distance(vertex) + (chart.corner[corner] - at).norm();
    if (by_corner <= way.length) way = {by_corner, field.label(vertex).value};
  }
  return way;
}

/// Measures with rays that end a little beyond a distance, and with longer ones until no place is farther than those.
/// `measure(radius)` returns the distance of the farthest.
template <class Measure>
void measure_within(double distance, double edge, Measure&& measure) {
  double radius = k_first_reach * distance + k_first_edge * edge;
  while (measure(radius) > radius) radius *= k_next_reach;
}

/// Calls `visit(i, chart, at)` for every place, with its face's chart and where it is in that.
template <class Visit>
void for_each_place(const Mesh& mesh, const SurfacePoints& places, const JobStage& stage, Visit&& visit) {
  for (std::size_t begin = 0, end = 0; begin < places.size(); begin = end) {
    const FaceChart chart(mesh, places[begin].face);
    for (; end < places.size() && places[end].face == places[begin].face; ++end) {
      if (end % k_checked == 0) stage.check();
      visit(end, chart, chart.to_plane(places[end].barycentric));
    }
  }
}

}  // namespace

CellMeasure::CellMeasure(const SaddleVertexGraph& graph, const GeodesicVoronoi& cells, const CellBorders& borders,
                         const std::vector<double>& reaches)
    : graph_(graph),
      mesh_(graph.mesh()),
      cells_(cells),
      borders_(borders),
      reaches_(reaches),
      border_(graph.unfolding()),
      about_(graph.unfolding()) {}

void CellMeasure::find_edge_distances(const CellTexels& texels, BakedCells& baked, const JobStage& stage) {
  const auto border = borders_.of(texels.cell);
  if (border.empty()) {
    for (const std::size_t texel : texels.texels) baked.edge_distance[texel] = std::numeric_limits<float>::infinity();
    return;
  }
  const WatchedPlaces places(texels.places);
  // By the site no place is farther; beyond that nothing is worth looking for.
  measure_within(2 * reaches_[texels.cell], mesh_.mean_edge_length(), [&](double radius) {
    border_.from_border(border, {.radius = radius}, &places, stage);
    double longest = 0;
    for_each_place(mesh_, texels.places, stage, [&](std::size_t i, const FaceChart& chart, const Vec2& at) {
      const Way way = way_to(border_.field(), mesh_, chart, texels.places[i], i, at);
      baked.edge_distance[texels.texels[i]] = static_cast<float>(std::max(0.0, way.length));
      longest = std::max(longest, way.length);
    });
    return longest;
  });
}

void CellMeasure::find_local_uv(const CellTexels& texels, const Vec3* axis, BakedCells& baked, const JobStage& stage) {
  const SurfacePoint site = center_of_map(cells_.sites[texels.cell]);
  const DirectionsAtPoint star(graph_.unfolding(), site);
  const WatchedPlaces places(texels.places);
  const double scale = angle_scale(mesh_, site), zero = axis ? start_angle(mesh_, site, *axis) : 0;
  std::vector<Way> ways(texels.places.size());
  measure_within(reaches_[texels.cell], mesh_.mean_edge_length(), [&](double radius) {
    send_rays_about(about_, star, radius, &places, stage);
    double longest = 0;
    std::optional<Vec3> here;  // the site, in the face that is looked at
    Index face = k_none;
    for_each_place(mesh_, texels.places, stage, [&](std::size_t i, const FaceChart& chart, const Vec2& at) {
      const SurfacePoint& place = texels.places[i];
      if (face != place.face) here = barycentric_in(mesh_, site, face = place.face);
      ways[i] = way_to(about_, mesh_, chart, place, i, at);
      if (here) {
        const Vec2 straight = at - chart.to_plane(*here);
        if (const double length = straight.norm(); length <= ways[i].length)
          ways[i] = {length, star.angle_of(face, std::atan2(straight.y(), straight.x()))};
      }
      longest = std::max(longest, ways[i].length);
    });
    return longest;
  });
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const double angle = (ways[i].label - zero) / scale;
    float* const uv = &baked.local_uv[2 * texels.texels[i]];
    uv[0] = static_cast<float>(ways[i].length * std::cos(angle));
    uv[1] = static_cast<float>(ways[i].length * std::sin(angle));
  }
}

}  // namespace saddleback
