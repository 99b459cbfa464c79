// Points on a mesh as a face and barycentric coordinates, and the flat chart of a face.

#include "saddleback/mesh/surface_points.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <string>

#include "saddleback/error.h"

#include "mesh/tables/flat_face.h"

namespace saddleback {
namespace {

/// Returns what is wrong with a point on a mesh of that many faces, empty when nothing is.
std::string fault_of(const SurfacePoint& point, Index face_count) {
  if (point.face < 0 || point.face >= face_count)
    return message("has face ", point.face, ", but the mesh has ", face_count, " faces");
  const Vec3& b = point.barycentric;
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(b[i])) return message("has barycentric coordinate ", i, " = ", b[i], ", which is not finite");
    if (b[i] < -k_barycentric_tolerance)
      return message("has barycentric coordinate ", i, " = ", b[i], ", which is negative");
  }
  if (std::abs(b.sum() - 1) > k_barycentric_tolerance)
    return message("has barycentric coordinates that sum to ", b.sum(), " instead of 1");
  return {};
}

/// Tells whether weights sum to 1 up to the last bits, bits, which are let be: points that were given out are
/// themselves when they come back.
bool is_normalized(const Vec3& barycentric) {
  constexpr double k_last_bits = 4 * std::numeric_limits<double>::epsilon();
  return barycentric.minCoeff() >= 0 && std::abs(barycentric.sum() - 1) <= k_last_bits;
}

}  // namespace

Vec3 position(const Mesh& mesh, const SurfacePoint& point) {
  const Triangle& triangle = mesh.triangles()[point.face];
  return point.barycentric[0] * mesh.position(triangle[0]) + point.barycentric[1] * mesh.position(triangle[1]) +
         point.barycentric[2] * mesh.position(triangle[2]);
}

SurfacePoint at_vertex(const Mesh& mesh, Index vertex) {
  const Index h = mesh.first_halfedge(vertex);
  return {Mesh::face_of(h), Vec3::Unit(h % 3)};
}

Index vertex_at(const Mesh& mesh, const SurfacePoint& point) {
  for (int i = 0; i < 3; ++i)
    if (point.barycentric[i] == 1.0) return mesh.triangles()[point.face][i];
  return k_none;
}

SurfacePoints surface_points(std::span<const Index> faces, std::span<const double> barycentric) {
  if (barycentric.size() != 3 * faces.size())
    throw InputError(message("barycentric: ", barycentric.size() / 3, " rows, but faces has ", faces.size()));
  SurfacePoints result(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    SurfacePoint& point = result[i];
    point = {faces[i], Vec3(barycentric[3 * i], barycentric[3 * i + 1], barycentric[3 * i + 2])};
    if (point.face < 0) throw InputError(message("faces: face ", point.face, " at [", i, "] is negative"));
    if (const std::string fault = fault_of(point, std::numeric_limits<Index>::max()); !fault.empty())
      throw InputError(message("barycentric: point ", i, " ", fault));
    if (!is_normalized(point.barycentric)) point.barycentric = normalized_barycentric(point.barycentric);
  }
  return result;
}

void check_surface_points(const Mesh& mesh, const SurfacePoints& points, const char* argument) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (const std::string fault = fault_of(points[i], mesh.face_count()); !fault.empty())
      throw InputError(message(argument, ": point ", i, " ", fault));
}

void check_surface_point(const Mesh& mesh, const SurfacePoint& point, const char* argument) {
  if (const std::string fault = fault_of(point, mesh.face_count()); !fault.empty())
    throw InputError(message(argument, ": the point ", fault));
}

Vec3 normalized_barycentric(const Vec3& barycentric) {
  const Vec3 positive = barycentric.cwiseMax(0.0);
  return positive / positive.sum();
}

FaceChart::FaceChart(const Mesh& mesh, Index face) {
  const FlatFace flat(mesh.corners(3 * face));
  for (int i = 0; i < 3; ++i) corner[i] = flat.corner[i];
}

Vec2 FaceChart::to_plane(const Vec3& barycentric) const {
  return barycentric[0] * corner[0] + barycentric[1] * corner[1] + barycentric[2] * corner[2];
}

Vec3 FaceChart::to_barycentric(const Vec2& xy) const {
  const double b2 = xy.y() / corner[2].y();
  const double b1 = (xy.x() - b2 * corner[2].x()) / corner[1].x();
  return {1 - b1 - b2, b1, b2};
}

Vec3 direction_in_space(const Mesh& mesh, Index face, double angle) {
  const Triangle& t = mesh.triangles()[face];
  if (mesh.is_intrinsic()) {
    const FaceChart chart(mesh, face);
    const Vec3 x = (mesh.position(t[1]) - mesh.position(t[0])) / chart.corner[1].x();
    const Vec3 y = (mesh.position(t[2]) - mesh.position(t[0]) - chart.corner[2].x() * x) / chart.corner[2].y();
    return (std::cos(angle) * x + std::sin(angle) * y).stableNormalized();
  }
  const Vec3 x = (mesh.position(t[1]) - mesh.position(t[0])).normalized();
  const Vec3 normal = x.cross(mesh.position(t[2]) - mesh.position(t[0])).normalized();
  return std::cos(angle) * x + std::sin(angle) * normal.cross(x);
}

}  // namespace saddleback
