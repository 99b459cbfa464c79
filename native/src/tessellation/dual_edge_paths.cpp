// A dual edge is the geodesic from site to site through the boundary between their cells. In the face of one of the
// boundary's straight bits the two sites have mirror images, as the bit's ends' distances say; that gives the direction
// at one site, and straightest geodesics from there are aimed until one meets the other site; else from that one.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>

#include "saddleback/error.h"
#include "saddleback/geodesics/geodesic_paths.h"
#include "saddleback/mesh/surface_curve.h"
#include "saddleback/tessellation/dual_mesh.h"

#include "support/threads/parallel.h"

namespace saddleback {
namespace {

constexpr double k_hit = 1e-9;         // relative to the length: a geodesic this near to its aim has met it
constexpr double k_same_sheet = 1e-6;  // barycentric: nearer to an edge than that a point is in both faces beside it
constexpr int k_most_shots = 20;

/// The place where a dual edge crosses the boundary, the distance of its sites from there, and the direction of the
/// face in which the left one lies.
struct Crossing {
  SurfacePoint point;
  double distance = 0, angle = 0;
  double angle_of_right = 0;    ///< the direction of the right one
  double height = 0, turn = 0;  ///< of the left site above the boundary's bit; from the crossing to the image beyond it
  bool is_aimed = false;        ///< some bit is long enough to tell a direction
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
            .height = height,
            .turn = std::atan2(foot - on_bit, height),
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
  if (mesh.is_intrinsic()) {  // which tells nothing of targets in other faces
    const std::optional<Vec3> place = barycentric_in(mesh, target, end.point.face);
    if (!place) return {std::numeric_limits<double>::infinity(), 0, 0};
    const FaceChart chart(mesh, end.point.face);
    const Vec2 step = chart.to_plane(*place) - chart.to_plane(end.point.barycentric);
    const Vec2 ahead(std::cos(end.angle), std::sin(end.angle));
    return {step.norm(), step.dot(ahead), step.dot(Vec2(-ahead.y(), ahead.x()))};
  }
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

/// Returns the path with its length measured along its polyline.
GeodesicPath measured(const Mesh& mesh, GeodesicPath path) {
  path.length = 0;
  for (std::size_t i = 1; i < path.points.size(); ++i)
    path.length += step_length(mesh, path.surface[i - 1], path.surface[i]);
  return path;
}

GeodesicPath reversed(GeodesicPath path) {
  std::ranges::reverse(path.points);
  std::ranges::reverse(path.surface);
  return path;
}

/// The shortest paths to the crossing, one after the other.
GeodesicPath over_crossing(const SaddleVertexGraph& graph, const SurfacePoint& left, const SurfacePoint& middle,
                           const SurfacePoint& right) {
  GeodesicPath path = shortest_path(graph, left, middle, {.shorten = true, .threads = 1});
  const GeodesicPath rest = reversed(shortest_path(graph, right, middle, {.shorten = true, .threads = 1}));
  path.points.insert(path.points.end(), rest.points.begin() + 1, rest.points.end());
  path.surface.insert(path.surface.end(), rest.surface.begin() + 1, rest.surface.end());
  return measured(graph.mesh(), std::move(path));
}

enum class Straight : std::uint8_t { none, to_right, to_left };

/// A dual edge: the straightest geodesic from site to site, or over the boundary where none is found.
struct Across {
  Crossing crossing;
  Straight straight;
  SurfacePoint from;  ///< the site that it was aimed from, in the face into which it leaves
  double angle, length;
};

/// A straightest geodesic that leaves a point in a face that it lies in.
struct Way {
  SurfacePoint from;
  double angle, length;
};

/// Aims a geodesic through the crossing from one of its sites at the other, from a site that lies in the direction
/// `aside` of the crossing's face; none where no geodesic near the first aims meets both.
std::optional<Way> way_through(const Mesh& mesh, const Crossing& crossing, const SurfacePoint& from,
                               const SurfacePoint& to, double aside, double turn) {
  double back = aside, half = crossing.distance;
  if (!aim(mesh, crossing.point, from, back, half)) return {};
  const TraceEnd at_from = trace_end(mesh, crossing.point, back, half);
  const std::optional<Vec3> place = barycentric_in(mesh, from, at_from.point.face);
  if (!place) return {};
  // Straight to the other site's image, which passes beside a short boundary; else over the crossing.
  Way way{{at_from.point.face, *place}, at_from.angle + std::numbers::pi + turn, 2 * crossing.height};
  if (way.length > 0 && aim(mesh, way.from, to, way.angle, way.length)) return way;
  if (turn == 0) return {};
  way.angle = at_from.angle + std::numbers::pi;
  way.length = 2 * half;
  return aim(mesh, way.from, to, way.angle, way.length) ? std::optional(way) : std::nullopt;
}

Across look_across(const Mesh& mesh, const GeodesicVoronoi& cells, Index polyline) {
  const SurfacePoint &left = cells.sites[cells.edge_cells[polyline][0]],
                     &right = cells.sites[cells.edge_cells[polyline][1]];
  const Crossing crossing = crossing_of(mesh, cells, polyline);
  const double chord = mesh.bird((position(mesh, left) - position(mesh, right)).norm());
  Across across{crossing, Straight::none, left, 0, std::max(2 * crossing.distance, chord)};
  if (!crossing.is_aimed || vertex_at(mesh, crossing.point) != k_none) return across;
  // A straightest way round the wrong side of a vertex is not the shortest.
  const double most = across.length * (1 + k_hit);
  std::optional<Way> way = way_through(mesh, crossing, left, right, crossing.angle, crossing.turn);
  if (way && way->length <= most) return {crossing, Straight::to_right, way->from, way->angle, way->length};
  // The right site is the left one's image at the bit: where vertices part the ways about a first aim, the other meets.
  way = way_through(mesh, crossing, right, left, crossing.angle_of_right, -crossing.turn);
  if (way && way->length <= most) return {crossing, Straight::to_left, way->from, way->angle, way->length};
  return across;
}

GeodesicPath path_across(const SaddleVertexGraph& graph, const GeodesicVoronoi& cells, Index polyline) {
  const Mesh& mesh = graph.mesh();
  const SurfacePoint &left = cells.sites[cells.edge_cells[polyline][0]],
                     &right = cells.sites[cells.edge_cells[polyline][1]];
  const Across across = look_across(mesh, cells, polyline);
  if (across.straight != Straight::none) {
    const bool is_to_left = across.straight == Straight::to_left;
    const SurfacePoint& end = is_to_left ? left : right;
    GeodesicPath path = trace(mesh, across.from, across.angle, across.length).path;
    const std::size_t last = path.surface.size() - 1;
    if (last > 0 && shared_face(mesh, path.surface[last - 1], end) != k_none) {
      path.surface[last] = end;
      path.points[last] = position(mesh, end);
      return measured(mesh, is_to_left ? reversed(std::move(path)) : std::move(path));
    }
  }
  return over_crossing(graph, left, across.crossing.point, right);
}

std::vector<Index> open_boundaries(const GeodesicVoronoi& cells) {
  std::vector<Index> open;
  for (Index polyline = 0; polyline < static_cast<Index>(cells.edge_cells.size()); ++polyline)
    if (!cells.edge_closed[polyline]) open.push_back(polyline);
  return open;
}

}  // namespace

std::vector<double> dual_edge_lengths(const Mesh& mesh, const GeodesicVoronoi& cells, int threads, Job* job) {
  const JobStage stage(job, "Measuring dual edges");
  const std::vector<Index> open = open_boundaries(cells);
  std::vector<double> lengths(open.size());
  parallel_for(static_cast<Index>(open.size()), threads, 16, [&](Index i, int) {
    stage.check();
    lengths[i] = look_across(mesh, cells, open[i]).length;
  });
  stage.update(1);
  return lengths;
}

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
