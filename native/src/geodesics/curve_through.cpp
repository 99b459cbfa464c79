#include "saddleback/geodesics/curve_through.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>
#include <vector>

#include "saddleback/error.h"
#include "saddleback/geodesics/geodesic_paths.h"
#include "saddleback/geodesics/shortened_curve.h"
#include "saddleback/mesh/trace.h"

namespace saddleback {
namespace {

/// The points of a way on the surface, from its begin to its end: neighbors share a face.
using Way = SurfacePoints;

Way reversed(Way way) {
  std::ranges::reverse(way);
  return way;
}

void append(Way& way, const Way& more) { way.insert(way.end(), more.begin(), more.end()); }

std::vector<double> lengths_along(const Mesh& mesh, const Way& way) {
  std::vector<double> lengths{0};
  for (std::size_t i = 1; i < way.size(); ++i)
    lengths.push_back(lengths.back() + step_length(mesh, way[i - 1], way[i]));
  return lengths;
}

/// Pulls a way tight. One without length stays as it is.
Way tight(const Mesh& mesh, const Way& way) {
  if (lengths_along(mesh, way).back() <= k_barycentric_tolerance * mesh.length(3 * way[0].face)) return way;
  return shortened_curve(SurfaceCurve(mesh, way)).surface;
}

std::pair<Way, Way> halves(const Mesh& mesh, const Way& way) {
  const std::vector<double> lengths = lengths_along(mesh, way);
  const double half = lengths.back() / 2;
  if (half == 0) return {way, {way.back()}};
  const std::size_t i = std::ranges::upper_bound(lengths, half) - lengths.begin();  // after the middle
  const Index face = shared_face(mesh, way[i - 1], way[i], k_barycentric_tolerance);
  const double share = (half - lengths[i - 1]) / (lengths[i] - lengths[i - 1]);
  const SurfacePoint middle{face, (1 - share) * *barycentric_in(mesh, way[i - 1], face, k_barycentric_tolerance) +
                                      share * *barycentric_in(mesh, way[i], face, k_barycentric_tolerance)};
  const auto at = way.begin() + static_cast<std::ptrdiff_t>(i);
  std::pair<Way, Way> result{{way.begin(), at}, {middle}};
  result.first.push_back(middle);
  result.second.insert(result.second.end(), at, way.end());
  return result;
}

/// Appends the Bezier curve of a control polygon.
void append_bezier(const Mesh& mesh, std::vector<Way> polygon, int halvings, const JobStage& stage, Way& curve) {
  stage.check();
  if (halvings == 0) {
    for (const Way& way : polygon) append(curve, way);
    return;
  }
  std::vector<Way> left, right;
  while (!polygon.empty()) {
    std::vector<Way> between;
    Way before;
    for (const Way& way : polygon) {
      auto [first, second] = halves(mesh, way);
      if (before.empty()) {
        left.push_back(first);
      } else {
        append(before, first);
        between.push_back(tight(mesh, before));
      }
      before = std::move(second);
    }
    right.push_back(std::move(before));
    polygon = std::move(between);
  }
  std::ranges::reverse(right);
  append_bezier(mesh, std::move(left), halvings - 1, stage, curve);
  append_bezier(mesh, std::move(right), halvings - 1, stage, curve);
}

/// Directions of ways from a point, as unit vectors about it; at an interior vertex angles are scaled to a full turn.
class Directions {
 public:
  Directions(const Mesh& mesh, const SurfacePoint& point) : mesh_(mesh), point_(point) {
    const Index vertex = vertex_at(mesh, point);
    if (vertex != k_none && !mesh.is_boundary(vertex)) scale_ = 2 * std::numbers::pi / mesh.total_angle(vertex);
  }
  Vec2 of(const Way& way) const {
    const Vec3 from = position(mesh_, point_);
    for (const SurfacePoint& next : way) {
      const Vec3 along = position(mesh_, next) - from;
      if (along.norm() == 0) continue;
      const double angle = scale_ * start_angle(mesh_, point_, along);
      return {std::cos(angle), std::sin(angle)};
    }
    return {1, 0};
  }
  Way way(const Vec2& direction, double length) const {
    double angle = std::atan2(direction.y(), direction.x());
    if (angle < 0) angle += 2 * std::numbers::pi;
    return trace(mesh_, point_, angle / scale_, length).path.surface;
  }

 private:
  const Mesh& mesh_;
  const SurfacePoint& point_;
  double scale_ = 1;
};

void check(const Mesh& mesh, const SurfacePoints& points, std::size_t least, bool closed, int halvings,
           const char* argument) {
  check_surface_points(mesh, points, argument);
  if (points.size() < least) throw InputError(message(argument, ": wanted at least ", least, ", got ", points.size()));
  if (halvings < 0 || halvings > 10) throw InputError(message("halvings: wanted 0 to 10, got ", halvings));
  const auto component = [&](std::size_t i) { return mesh.component_of(mesh.triangles()[points[i].face][0]); };
  for (std::size_t i = closed ? 0 : 1; i < points.size(); ++i) {
    const std::size_t before = (i + points.size() - 1) % points.size();
    if (component(before) != component(i)) {
      throw InputError(message(argument, ": points ", before, " and ", i,
                               " are on different components of the mesh, between which there is no way"));
    }
    if (step_length(mesh, points[before], points[i]) == 0) {
      throw InputError(message(argument, ": points ", before, " and ", i, " are the same; leave one out"));
    }
  }
}

/// Returns the shortest ways from each point to the next.
std::vector<Way> shortest_ways(const SaddleVertexGraph& graph, const SurfacePoints& points, bool closed,
                               const JobStage& stage) {
  std::vector<Way> ways;
  const std::size_t count = closed ? points.size() : points.size() - 1;
  for (std::size_t i = 0; i < count; ++i) {
    stage.update(static_cast<double>(i) / static_cast<double>(count));
    ways.push_back(shortest_path(graph, points[i], points[(i + 1) % points.size()], {.shorten = true}).surface);
  }
  return ways;
}

}  // namespace

SurfaceCurve curve_through(const SaddleVertexGraph& graph, const SurfacePoints& points,
                           const CurveThroughOptions& options, Job* job) {
  const Mesh& mesh = graph.mesh();
  if (options.smooth) mesh.require_space("smooth");
  check(mesh, points, options.closed ? 3 : 2, options.closed, options.halvings, "points");
  const JobStage stage(job, "Drawing a curve");
  const std::vector<Way> ways = shortest_ways(graph, points, options.closed, stage.part(0, options.smooth ? 0.5 : 1));
  const std::size_t count = ways.size();
  Way curve;
  if (options.smooth) {
    // About each point the ways to and from its neighbors bend to the bisector of their directions.
    std::vector<Way> out(count), back(count);  // a third of each way long, at its begin and its end
    const auto length = [&](std::size_t i) { return lengths_along(mesh, ways[i]).back(); };
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t next = (i + 1) % points.size();
      const Directions about(mesh, points[next]);
      const Way arriving = reversed(ways[i]);
      if (!options.closed && i == 0)
        out[0] = Directions(mesh, points[0]).way(Directions(mesh, points[0]).of(ways[0]), length(0) / 3);
      if (!options.closed && next == points.size() - 1) {
        back[i] = about.way(about.of(arriving), length(i) / 3);
        continue;
      }
      const Vec2 ahead = about.of(ways[next]), behind = about.of(arriving);
      const Vec2 along = (ahead - behind).norm() > 1e-9 ? Vec2(ahead - behind) : Vec2(ahead.y(), -ahead.x());
      out[next] = about.way(along, length(next) / 3);
      back[i] = about.way(-along, length(i) / 3);
    }
    for (std::size_t i = 0; i < count; ++i) {
      stage.part(0.5, 1).update(static_cast<double>(i) / static_cast<double>(count));
      Way middle = reversed(out[i]);
      append(middle, ways[i]);
      append(middle, back[i]);
      append_bezier(mesh, {out[i], tight(mesh, middle), reversed(back[i])}, options.halvings, stage, curve);
    }
  } else {
    for (const Way& way : ways) append(curve, way);
  }
  stage.update(1);
  return {mesh, std::move(curve), options.closed, "points"};
}

SurfaceCurve bezier_curve(const SaddleVertexGraph& graph, const SurfacePoints& controls, int halvings, Job* job) {
  const Mesh& mesh = graph.mesh();
  check(mesh, controls, 2, false, halvings, "controls");
  const JobStage stage(job, "Drawing a curve");
  Way curve;
  append_bezier(mesh, shortest_ways(graph, controls, false, stage.part(0, 0.5)), halvings, stage, curve);
  stage.update(1);
  return {mesh, std::move(curve), false, "controls"};
}

}  // namespace saddleback
