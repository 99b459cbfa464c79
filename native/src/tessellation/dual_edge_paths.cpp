// A dual edge is the geodesic from site to site over the boundary between their cells. In the face of one of the
// boundary's straight bits the two sites have mirror images, as the bit's ends' distances say; that gives the
// directions in which straightest geodesics are aimed until they meet both sites; exact cells know the ways from beside
// the bit. Where the boundary is nearest to its sites at one of its ends the two meet at an angle: the curve is
// tightened.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "saddleback/geodesics/geodesic_paths.h"
#include "saddleback/geodesics/shortened_curve.h"
#include "saddleback/mesh/surface_curve.h"
#include "saddleback/tessellation/dual_mesh.h"

#include "support/threads/parallel.h"

namespace saddleback {
namespace {

constexpr double k_hit = 1e-9;         // relative to the length: a geodesic this near to its aim has met it
constexpr double k_same_sheet = 1e-6;  // barycentric: nearer to an edge than that a point is in both faces beside it
constexpr double k_longer = 5e-3;      // than the cells of usual graphs say: round the wrong side of a vertex
constexpr int k_most_shots = 20;
// Of the distance: so far from the boundary places are the site's, but where another site is beside it.
constexpr std::array k_beside = {1e-5, 1e-4, 1e-3, 1e-2, 1e-1};

/// The place where a dual edge crosses the boundary, the distance of its sites from there, and the direction of the
/// face in which the left one lies.
struct Crossing {
  SurfacePoint point;
  double distance = 0, angle = 0;
  double angle_of_right = 0;  ///< the direction of the right one
  bool is_aimed = false;      ///< some bit is long enough to tell a direction
};

/// Returns the crossing where the boundary is nearest to its sites.
Crossing crossing_of(const Mesh& mesh, const GeodesicVoronoi& cells, Index polyline) {
  const Index first = cells.edge_points[cells.edge_offsets[polyline]];
  Crossing best{.point = cells.points[first], .distance = cells.point_distance[first]};
  for (Index i = cells.edge_offsets[polyline]; i + 1 < cells.edge_offsets[polyline + 1]; ++i) {
    const Index a = cells.edge_points[i], b = cells.edge_points[i + 1];
    const Index face = shared_face(mesh, cells.points[a], cells.points[b]);
    if (face == k_none) continue;
    const FaceChart chart(mesh, face);
    const Vec2 begin = chart.to_plane(*barycentric_in(mesh, cells.points[a], face));
    const Vec2 step = chart.to_plane(*barycentric_in(mesh, cells.points[b], face)) - begin;
    const double length = step.norm(), from_a = cells.point_distance[a], from_b = cells.point_distance[b];
    if (!(length > 1e-6 * (from_a + from_b))) continue;  // too short to tell a direction
    const double foot = (from_a * from_a - from_b * from_b + length * length) / (2 * length);
    const Vec2 along = step / length, to_left(-along.y(), along.x());
    const double on_bit = std::clamp(foot, 0.0, length);
    const double height = std::sqrt(std::max(0.0, from_a * from_a - foot * foot));
    const Vec2 to_site = (foot - on_bit) * along + height * to_left;
    const Vec2 to_right = (foot - on_bit) * along - height * to_left;
    if (best.is_aimed && to_site.norm() >= best.distance) continue;
    best = {.point = {face, normalized_barycentric(chart.to_barycentric(begin + on_bit * along))},
            .distance = to_site.norm(),
            .angle = std::atan2(to_site.y(), to_site.x()),
            .angle_of_right = std::atan2(to_right.y(), to_right.x()),
            .is_aimed = true};
  }
  return best;
}

/// The target as seen from where a geodesic ended.
struct Miss {
  double distance;     ///< through space: beyond an edge the target lies above or below the plane of the face
  double ahead, left;  ///< in that plane
};

Miss miss_of(const Mesh& mesh, const TraceEnd& end, const SurfacePoint& target) {
  if (const std::optional<Vec3> place = barycentric_in(mesh, target, end.point.face)) {
    const FaceChart chart(mesh, end.point.face);
    const Vec2 step = chart.to_plane(*place) - chart.to_plane(end.point.barycentric);
    const Vec2 ahead(std::cos(end.angle), std::sin(end.angle));
    return {step.norm(), step.dot(ahead), step.dot(Vec2(-ahead.y(), ahead.x()))};
  }
  if (mesh.is_intrinsic()) return {std::numeric_limits<double>::infinity(), 0, 0};  // tells no places of other faces
  const Vec3 step = position(mesh, target) - position(mesh, end.point);
  const Vec3 ahead = direction_in_space(mesh, end.point.face, end.angle);
  const Vec3 left = direction_in_space(mesh, end.point.face, end.angle + std::numbers::pi / 2);
  return {step.norm(), step.dot(ahead), step.dot(left)};
}

/// Aims a straightest geodesic until it meets the target; false where none near the first aim does.
bool aim(const Mesh& mesh, const SurfacePoint& from, const SurfacePoint& target, double& angle, double& length) {
  double before = std::numeric_limits<double>::infinity();
  for (int shot = 0; shot < k_most_shots; ++shot) {
    const TraceEnd end = trace_end(mesh, from, angle, length);
    const Miss miss = miss_of(mesh, end, target);
    // Where the surface passes through itself, what is near in space may be on another sheet.
    if (miss.distance <= k_hit * length) return shared_face(mesh, end.point, target, k_same_sheet) != k_none;
    if (!(miss.distance < before)) return false;
    before = miss.distance;
    angle += std::atan2(miss.left, length + miss.ahead);
    length += miss.ahead;
    if (!(length > 0)) return false;
  }
  return false;
}

/// The curve pulled tight, with its length measured along its polyline.
GeodesicPath tightened(const Mesh& mesh, SurfacePoints points) {
  GeodesicPath path = shortened_curve(SurfaceCurve(mesh, std::move(points)));
  path.length = 0;
  for (std::size_t i = 1; i < path.surface.size(); ++i)
    path.length += step_length(mesh, path.surface[i - 1], path.surface[i]);
  return path;
}

/// Appends the shortest way from the crossing to a site, by exact distances, which are known beside the boundary.
/// \return false where none of the places about that direction is the site's: at a border it may lead off the surface.
bool append_exact_way(const Mesh& mesh, const GeodesicVoronoi& cells, const Crossing& crossing, Index site,
                      double angle, SurfacePoints& points) {
  for (const double share : k_beside)
    for (const double turn : {0.0, 0.5, -0.5, 1.0, -1.0}) {
      const double set_out = angle_about(mesh, crossing.point, angle + turn);
      const SurfacePoints step = trace(mesh, crossing.point, set_out, share * crossing.distance).path.surface;
      const Index source = cells.exact_field->nearest_at(step.back()).source;
      if (source == k_none || cells.exact_sites[source] != site) continue;
      const SurfacePoints way = cells.exact_field->path(step.back()).surface;
      points.insert(points.end(), step.begin() + 1, step.end());
      points.insert(points.end(), way.rbegin() + 1, way.rend());
      return true;
    }
  return false;
}

/// Appends the straightest geodesic from the crossing to a site that lies in that direction, but for the crossing.
/// \return false where none near it meets the site.
bool append_straight_way(const Mesh& mesh, const Crossing& crossing, const SurfacePoint& site, double angle,
                         SurfacePoints& points) {
  double length = crossing.distance;
  if (vertex_at(mesh, crossing.point) != k_none || !aim(mesh, crossing.point, site, angle, length)) return false;
  if (length > crossing.distance * (1 + k_longer)) return false;
  const SurfacePoints way = trace(mesh, crossing.point, angle, length).path.surface;
  if (way.size() < 2 || shared_face(mesh, way[way.size() - 2], site) == k_none) return false;
  points.insert(points.end(), way.begin() + 1, way.end() - 1);
  points.push_back(site);
  return true;
}

/// The shortest way from the left site to the right one in the class of the one over the crossing; none where the cells
/// do not tell that one, as it bends about vertices.
std::optional<GeodesicPath> way_across(const Mesh& mesh, const GeodesicVoronoi& cells, Index polyline,
                                       const Crossing& crossing) {
  if (!crossing.is_aimed) return {};
  SurfacePoints points;
  const auto append = [&](Index site, double angle) {
    return (cells.exact_field && append_exact_way(mesh, cells, crossing, site, angle, points)) ||
           append_straight_way(mesh, crossing, cells.sites[site], angle, points);
  };
  const auto& [left, right] = cells.edge_cells[polyline];
  if (!append(left, crossing.angle)) return {};
  std::ranges::reverse(points);
  points.push_back(crossing.point);
  if (!append(right, crossing.angle_of_right)) return {};
  return tightened(mesh, std::move(points));
}

GeodesicPath path_across(const SaddleVertexGraph& graph, const GeodesicVoronoi& cells, Index polyline) {
  const Mesh& mesh = graph.mesh();
  const Crossing crossing = crossing_of(mesh, cells, polyline);
  if (std::optional<GeodesicPath> way = way_across(mesh, cells, polyline, crossing)) return *std::move(way);
  const auto& [left, right] = cells.edge_cells[polyline];
  SurfacePoints points = shortest_path(graph, cells.sites[left], crossing.point, {.threads = 1}).surface;
  const SurfacePoints rest = shortest_path(graph, cells.sites[right], crossing.point, {.threads = 1}).surface;
  points.insert(points.end(), rest.rbegin() + 1, rest.rend());
  return tightened(mesh, std::move(points));
}

std::vector<Index> open_boundaries(const GeodesicVoronoi& cells) {
  std::vector<Index> open;
  for (Index polyline = 0; polyline < static_cast<Index>(cells.edge_cells.size()); ++polyline)
    if (!cells.edge_closed[polyline]) open.push_back(polyline);
  return open;
}

}  // namespace

std::vector<GeodesicPath> dual_edge_paths(const SaddleVertexGraph& graph, const GeodesicVoronoi& cells, int threads,
                                          Job* job) {
  const JobStage stage(job, "Tracing dual edges");
  const std::vector<Index> open = open_boundaries(cells);
  std::vector<GeodesicPath> paths(open.size());
  parallel_for(static_cast<Index>(open.size()), threads, 16, [&](Index i, int) {
    stage.check();
    paths[i] = path_across(graph, cells, open[i]);
  });
  stage.update(1);
  return paths;
}

}  // namespace saddleback
