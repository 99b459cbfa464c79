#include "tessellation/log_map/tangent_moves.h"

#include <cmath>
#include <numbers>

#include "saddleback/error.h"
#include "saddleback/mesh/trace.h"

#include "support/threads/parallel.h"

namespace saddleback {
namespace {

/// Radians of surface per radian of the tangent plane, which is scaled at vertices inside the mesh.
double surface_scale(const Mesh& mesh, const SurfacePoint& point) {
  const Index vertex = vertex_at(mesh, point);
  return vertex == k_none || mesh.is_boundary(vertex) ? 1 : mesh.total_angle(vertex) / (2 * std::numbers::pi);
}

Vec2 turned(const Vec2& v, const Vec2& turn) {
  const double c = turn.x(), s = turn.y();
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

void move_site(const Mesh& mesh, const SurfacePoint& site, const Vec2& step, Index i, Moved& moved) {
  moved.sites[i] = site;
  const double length = step.norm();
  if (!(length > 0) || !std::isfinite(length)) return;
  const double heading = std::atan2(step.y(), step.x());
  try {
    const TraceEnd end = trace_end(mesh, site, surface_angle(mesh, site, heading), length);
    moved.sites[i] = end.point;
    const double angle_turned = tangent_heading(mesh, end.point, end.angle) - heading;
    moved.turns[i] = Vec2(std::cos(angle_turned), std::sin(angle_turned));
    moved.steps[i] = turned(step * (end.length / length), moved.turns[i]);
  } catch (const InputError&) {
    moved.sites[i] = site;  // the curve would turn without end
  }
}

}  // namespace

Vec2 in_chart(const Mesh& mesh, Index face, const Vec3& vector) {
  const Triangle& t = mesh.triangles()[face];
  const Vec3 a = mesh.positions()[t[1]] - mesh.positions()[t[0]], b = mesh.positions()[t[2]] - mesh.positions()[t[0]];
  const double aa = a.squaredNorm(), ab = a.dot(b), bb = b.squaredNorm(), va = vector.dot(a), vb = vector.dot(b);
  const double determinant = aa * bb - ab * ab;
  if (!(determinant > 0)) return Vec2::Zero();
  const double along_a = (va * bb - vb * ab) / determinant, along_b = (vb * aa - va * ab) / determinant;
  const FaceChart chart(mesh, face);
  return along_a * (chart.corner[1] - chart.corner[0]) + along_b * (chart.corner[2] - chart.corner[0]);
}

double tangent_heading(const Mesh& mesh, const SurfacePoint& point, double chart_angle) {
  return angle_about(mesh, point, chart_angle) / surface_scale(mesh, point);
}

double surface_angle(const Mesh& mesh, const SurfacePoint& point, double heading) {
  const Index vertex = vertex_at(mesh, point);
  const double scale = surface_scale(mesh, point), around = 2 * std::numbers::pi;
  if (vertex != k_none && mesh.is_boundary(vertex))
    return heading < (mesh.total_angle(vertex) - around) / 2 ? heading + around : heading;
  return scale == 1 ? heading : (heading < 0 ? heading + around : heading) * scale;
}

Moved move_sites(const Mesh& mesh, const SurfacePoints& sites, const TangentField& steps, int threads,
                 std::span<const Index> order) {
  Moved moved{SurfacePoints(sites.size()), TangentField(sites.size(), Vec2::Zero()),
              TangentField(sites.size(), Vec2(1, 0))};
  parallel_for(static_cast<Index>(sites.size()), threads, 32, [&](Index i, int) {
    const Index site = order.empty() ? i : order[i];
    move_site(mesh, sites[site], steps[site], site, moved);
  });
  return moved;
}

void transport(const Moved& moved, TangentField& field) {
  for (std::size_t i = 0; i < field.size(); ++i) field[i] = turned(field[i], moved.turns[i]);
}

double dot(const TangentField& a, const TangentField& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

}  // namespace saddleback
