#include "saddleback/shape_mapping/conform.h"

#include <cmath>

#include "saddleback/error.h"

#include "shape_mapping/outline_mapper.h"

namespace saddleback {
namespace {

void check_points(std::span<const Vec3> points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].allFinite()) throw InputError(message("vertices: coordinates at [", i, "] are not finite"));
}

Vec3 face_normal(const Mesh& mesh, Index face) {
  const Vec3& a = mesh.position(mesh.from(3 * face));
  return (mesh.position(mesh.to(3 * face)) - a).cross(mesh.position(mesh.apex(3 * face)) - a).normalized();
}

}  // namespace

Conformer::Conformer(const Mesh& mesh) : mapper_(std::make_unique<OutlineMapper>(mesh)) {}
Conformer::~Conformer() = default;
Conformer::Conformer(Conformer&&) noexcept = default;
Conformer& Conformer::operator=(Conformer&&) noexcept = default;

ConformedPoints Conformer::conform(const Shape& shape, const Placement& placement, const DirectionField* field,
                                   std::span<const Vec3> points, const MapLimits& limits) {
  check_points(points);
  ConformedPoints result;
  SurfaceOutline outline;
  result.failure = map_shape(*mapper_, shape, placement, field, outline, limits);
  if (result.failure != MapFailure::none) return result;
  const ShapeMap& plane = mapper_->plane();
  Index face = plane.center_face();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 place = mapper_->laid(points[i].head<2>());
    if (mapper_->find(place, face) == MapFailure::none) {
      result.anchors.push_back(plane.surface_point(place, face));
    } else {
      result.lost.push_back(static_cast<Index>(i));
      result.anchors.push_back(placement.center);
    }
    result.heights.push_back(placement.scale * points[i].z());
  }
  return result;
}

std::vector<Vec3> vertex_normals(const Mesh& mesh) {
  mesh.require_space("a normal");
  std::vector<Vec3> normals(static_cast<std::size_t>(mesh.vertex_count()), Vec3::Zero());
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const Vec3 normal = face_normal(mesh, f);
    for (Index h = 3 * f; h < 3 * f + 3; ++h) normals[mesh.from(h)] += mesh.corner_angle(h) * normal;
  }
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const double length = normals[v].norm();
    // Two sheets back to back cancel out: one of them has to do.
    normals[v] = length > 1e-12 ? Vec3(normals[v] / length) : face_normal(mesh, Mesh::face_of(mesh.first_halfedge(v)));
  }
  return normals;
}

Vec3 normal_at(const Mesh& mesh, std::span<const Vec3> vertex_normals, const SurfacePoint& point) {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < 3; ++i) sum += point.barycentric[i] * vertex_normals[mesh.from(3 * point.face + i)];
  const double length = sum.norm();
  return length > 1e-12 ? Vec3(sum / length) : face_normal(mesh, point.face);
}

std::vector<Vec3> positions_of(const Mesh& mesh, std::span<const Vec3> vertex_normals, const SurfacePoints& anchors,
                               std::span<const double> heights) {
  mesh.require_space("a normal");
  std::vector<Vec3> result;
  result.reserve(anchors.size());
  for (std::size_t i = 0; i < anchors.size(); ++i)
    result.push_back(position(mesh, anchors[i]) + heights[i] * normal_at(mesh, vertex_normals, anchors[i]));
  return result;
}

std::vector<RigidFrame> rigid_frames(const Mesh& mesh, std::span<const Vec3> vertex_normals,
                                     std::span<const Placement> placements) {
  mesh.require_space("a normal");
  std::vector<RigidFrame> result;
  result.reserve(placements.size());
  for (const Placement& placement : placements) {
    const Vec3 z = normal_at(mesh, vertex_normals, placement.center);
    const Vec3 along = direction_in_space(mesh, placement.center.face, placement.angle);
    Vec3 y = z.cross(along);
    if (!(y.norm() > 1e-12)) y = z.cross(direction_in_space(mesh, placement.center.face, placement.angle + 1));
    y.normalize();
    Eigen::Matrix3d axes;
    axes << y.cross(z), y, z;
    const double s = placement.scale;
    result.push_back({position(mesh, placement.center), Eigen::Quaterniond(axes).normalized(),
                      Vec3(s, placement.mirrored ? -s : s, s)});
  }
  return result;
}

}  // namespace saddleback
