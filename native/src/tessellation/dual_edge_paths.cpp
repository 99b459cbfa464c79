// A dual edge is the geodesic from site to site through the boundary between their cells. In the face of one of the
// boundary's straight bits the two sites have mirror images, as the bit's ends' distances say; that gives the direction
// at one site, and straightest geodesics from there are aimed until one meets the other site.

#include <algorithm>
#include <cmath>

#include "saddleback/dual_mesh.h"
#include "saddleback/error.h"
#include "saddleback/geodesic_paths.h"
#include "saddleback/surface_curve.h"

#include "support/parallel.h"

namespace saddleback {
namespace {

constexpr double k_hit = 1e-9;  // relative to the length: a geodesic this near to its aim has met it
constexpr int k_most_shots = 20;

/// Where a dual edge crosses the boundary, and in which direction of the face its left site lies how far.
struct Crossing {
  SurfacePoint point;
  double angle = 0, distance = 0;
};

/// On the bit of a boundary in whose face the images' foot lies, or lies nearest to.
Crossing crossing_of(const Mesh& mesh, const GeodesicVoronoi& cells, Index polyline) {
  double least_miss = std::numeric_limits<double>::infinity();
  Crossing best;
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
    const double miss = std::max({0.0, -foot, foot - length});
    if (miss >= least_miss) continue;
    least_miss = miss;
    const Vec2 along = step / length, to_left(-along.y(), along.x());
    const double on_bit = std::clamp(foot, 0.0, length);
    const double height = std::sqrt(std::max(0.0, from_a * from_a - foot * foot));
    const Vec2 to_site = (foot - on_bit) * along + height * to_left;
    best = {{face, normalised_barycentric(chart.to_barycentric(begin + on_bit * along))},
            std::atan2(to_site.y(), to_site.x()),
            to_site.norm()};
  }
  return best;
}

/// The target as seen from where a geodesic ended, in the plane of that face: how far ahead, and how far to the left.
Vec2 miss_of(const Mesh& mesh, const TraceEnd& end, const SurfacePoint& target) {
  const Vec3 step = position(mesh, target) - position(mesh, end.point);
  const Vec3 ahead = direction_in_space(mesh, end.point.face, end.angle);
  const Vec3 left = direction_in_space(mesh, end.point.face, end.angle + M_PI / 2);
  return {step.dot(ahead), step.dot(left)};
}

/// Aims a straightest geodesic until it meets the target; false where none near the first aim does.
bool aim(const Mesh& mesh, const SurfacePoint& from, const SurfacePoint& target, double& angle, double& length) {
  double before = std::numeric_limits<double>::infinity();
  for (int shot = 0; shot < k_most_shots; ++shot) {
    const Vec2 miss = miss_of(mesh, trace_end(mesh, from, angle, length), target);
    if (miss.norm() <= k_hit * length) return true;
    if (!(miss.norm() < before)) return false;
    before = miss.norm();
    angle += std::atan2(miss.y(), length + miss.x());
    length += miss.x();
    if (!(length > 0)) return false;
  }
  return false;
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
  path.length += rest.length;
  return path;
}

GeodesicPath path_across(const SaddleVertexGraph& graph, const GeodesicVoronoi& cells, Index polyline) {
  const Mesh& mesh = graph.mesh();
  const SurfacePoint &left = cells.sites[cells.edge_cells[polyline][0]],
                     &right = cells.sites[cells.edge_cells[polyline][1]];
  const Crossing crossing = crossing_of(mesh, cells, polyline);
  if (!(crossing.distance > 0)) {
    return over_crossing(graph, left, cells.points[cells.edge_points[cells.edge_offsets[polyline]]], right);
  }
  double back = crossing.angle, half = crossing.distance;
  if (vertex_at(mesh, crossing.point) == k_none && aim(mesh, crossing.point, left, back, half)) {
    const TraceEnd at_left = trace_end(mesh, crossing.point, back, half);
    const Vec3 out = -direction_in_space(mesh, at_left.point.face, at_left.angle);
    double angle = start_angle(mesh, left, out), length = 2 * half;
    if (aim(mesh, left, right, angle, length)) {
      GeodesicPath path = trace(mesh, left, angle, length).path;
      const std::size_t last = path.surface.size() - 1;
      if (last > 0 && shared_face(mesh, path.surface[last - 1], right) != k_none) {
        path.surface[last] = right;
        path.points[last] = position(mesh, right);
        return path;
      }
    }
  }
  return over_crossing(graph, left, crossing.point, right);
}

}  // namespace

std::vector<GeodesicPath> dual_edge_paths(const SaddleVertexGraph& graph, const GeodesicVoronoi& cells, int threads,
                                          Job* job) {
  const JobStage stage(job, "Tracing dual edges");
  std::vector<Index> open;
  for (Index polyline = 0; polyline < static_cast<Index>(cells.edge_cells.size()); ++polyline)
    if (!cells.edge_closed[polyline]) open.push_back(polyline);
  std::vector<GeodesicPath> paths(open.size());
  parallel_for(static_cast<Index>(open.size()), threads, 16, [&](Index i, int) {
    stage.check();
    paths[i] = path_across(graph, cells, open[i]);
  });
  stage.update(1);
  return paths;
}

}  // namespace saddleback
