#include "saddleback/geodesics/log_map.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "saddleback/error.h"
#include "saddleback/mesh/trace.h"

#include "geodesics/wavefront/directions_at_point.h"
#include "geodesics/wavefront/log_about.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

// A barycentric distance: from nearer to a vertex, rays past it on both sides cannot be told apart.
constexpr double k_at_vertex = 1e-10;
// The share of the time until all is measured; the results are then sorted and written.
constexpr double k_measured = 0.97;

/// An angle of -pi to pi about a vertex as one of 0 to its total angle, scaled. Rounding may put a direction along the
/// border before it.
double from_zero(const Mesh& mesh, Index vertex, double angle) {
  if (vertex == k_none || angle >= 0) return angle;
  const double turned = angle + 2 * std::numbers::pi;
  return mesh.is_boundary(vertex) && turned - mesh.total_angle(vertex) > -angle ? angle : turned;
}

}  // namespace

double angle_scale(const Mesh& mesh, const SurfacePoint& point) {
  const Index vertex = vertex_at(mesh, point);
  if (vertex == k_none || mesh.is_boundary(vertex)) return 1;
  return mesh.total_angle(vertex) / (2 * std::numbers::pi);
}

LogMap log_map(const SaddleVertexGraph& graph, const SurfacePoint& center, double radius, Job* job) {
  check_surface_point(graph.mesh(), center, "center");
  if (!(radius > 0)) throw InputError(message("radius: wanted a distance above 0, got ", radius));
  const JobStage stage(job, "Measuring about the point");
  PlaceDistances none;
  LogMap result = log_about(graph, center, radius, nullptr, none, stage);
  stage.update(1);
  return result;
}

SurfacePoint center_of_map(const SurfacePoint& given) {
  SurfacePoint center{given.face, normalized_barycentric(given.barycentric)};
  for (int i = 0; i < 3; ++i)
    if (center.barycentric[i] >= 1 - k_at_vertex) center.barycentric = Vec3::Unit(i);
  return center;
}

void send_rays_about(WavefrontDistances& field, const DirectionsAtPoint& center, double radius,
                     const WatchedPlaces* places, const JobStage& stage, const ReportRays& report) {
  field.begin(places);
  if (center.vertex() != k_none) field.add_source(center.vertex(), {0, 0, 0, false});
  const RayWindow window{Vec2::Zero(), 0, 0, 0, 0, k_none, Rays::from_point, 0, false};
  center.emit(field, window, center.begin(), center.begin() + center.total_angle());
  field.run({.radius = radius}, stage, report);
}

LogMap log_about(const SaddleVertexGraph& graph, const SurfacePoint& center, double radius, const WatchedPlaces* places,
                 PlaceDistances& found, const JobStage& stage) {
  const Mesh& mesh = graph.mesh();
  const SurfacePoint point = center_of_map(center);
  WavefrontDistances field(graph.unfolding());
  const DirectionsAtPoint star(graph.unfolding(), point);
  const JobStage measuring = stage.part(0, k_measured);
  send_rays_about(field, star, radius, places, stage, [&](double distance, Index vertices) {
    measuring.update(
        std::max(distance / radius * distance / radius, static_cast<double>(vertices) / mesh.vertex_count()));
  });
  LogMap result;
  result.vertices = field.settled();
  std::ranges::sort(result.vertices);
  const double scale = angle_scale(mesh, point);
  for (const Index vertex : result.vertices) {
    const RayLabel& label = field.label(vertex);
    double angle = label.value;
    if (star.is_round()) {
      const double turns = std::floor((angle - star.begin()) / star.total_angle());
      angle -= turns * star.total_angle();
    } else if (star.vertex() == k_none) {
      angle = star.begin() + std::remainder(angle - star.begin(), 2 * std::numbers::pi);
    } else {
      angle = std::clamp(angle, star.begin(), star.begin() + star.total_angle());
    }
    result.distance.push_back(label.distance);
    result.angle.push_back(angle);
    result.uv.emplace_back(label.distance * std::cos(angle / scale), label.distance * std::sin(angle / scale));
    result.shadowed.push_back(label.shadowed);
  }
  found = field.places();
  return result;
}

SurfacePoints exp_map(const Mesh& mesh, const SurfacePoint& given, std::span<const Vec2> uv, int threads, Job* job) {
  check_surface_point(mesh, given, "center");
  const SurfacePoint center = center_of_map(given);
  if (threads < 0) throw InputError(message("threads: wanted 0 (all) or more, got ", threads));
  const auto count = static_cast<Index>(uv.size());
  for (Index i = 0; i < count; ++i) {
    if (!uv[i].allFinite())
      throw InputError(message("uv: vector ", i, " is (", uv[i].x(), ", ", uv[i].y(), "), which is not finite"));
  }
  const JobStage stage(job, "Tracing");
  const Index vertex = vertex_at(mesh, center);
  const double scale = angle_scale(mesh, center);
  SurfacePoints result(uv.size());
  std::atomic<Index> done{0};
  parallel_for(count, threads, 64, [&](Index i, int) {
    const double angle = std::atan2(uv[i].y(), uv[i].x());
    result[i] = trace_end(mesh, center, from_zero(mesh, vertex, angle) * scale, uv[i].stableNorm()).point;
    if (const Index n = done.fetch_add(1, std::memory_order_relaxed) + 1; n % 64 == 0)
      stage.update(static_cast<double>(n) / count);
  });
  stage.update(1);
  return result;
}

}  // namespace saddleback
