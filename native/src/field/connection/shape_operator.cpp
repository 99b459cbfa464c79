#include "field/connection/shape_operator.h"

#include <Eigen/Dense>
#include <cmath>

#include "saddleback/field/curvature.h"

#include "field/linear/row_blocks.h"
#include "support/hypotenuse.h"

namespace saddleback {
namespace {

Vec3 face_normal(const Mesh& mesh, Index face) {
  const Triangle& t = mesh.triangles()[face];
  return (mesh.position(t[1]) - mesh.position(t[0])).cross(mesh.position(t[2]) - mesh.position(t[0])).normalized();
}

/// Calls visit(h) for the half-edges out of a vertex, one a face.
template <class Visit>
void for_fan(const Mesh& mesh, Index vertex, Visit&& visit) {
  const Index first = mesh.first_halfedge(vertex);
  Index h = first;
  do {
    visit(h);
    h = mesh.rotate(h);
  } while (h != k_none && h != first);
}

/// Means by angle. Where faces lie folded onto each other these are nothing but rounding, or zero; there the normal of
/// the face of the widest corner stands for all.
std::vector<Vec3> vertex_normals(const Mesh& mesh) {
  constexpr double k_rounding = 1e-12;
  std::vector<Vec3> normals(mesh.vertex_count()), of_faces(mesh.face_count());
  for_rows(0, mesh.face_count(), 0, [&](Index f) { of_faces[f] = face_normal(mesh, f); });
  for_rows(0, mesh.vertex_count(), 0, [&](Index v) {
    Vec3 normal = Vec3::Zero();
    Index widest = mesh.first_halfedge(v);
    for_fan(mesh, v, [&](Index h) {
      normal += mesh.corner_angle(h) * of_faces[Mesh::face_of(h)];
      const double more = mesh.corner_angle(h) - mesh.corner_angle(widest);
      if (more > 0 || (more == 0 && h < widest)) widest = h;
    });
    if (normal.norm() <= k_rounding * mesh.corner_angle(widest)) normal = of_faces[Mesh::face_of(widest)];
    normals[v] = normal.normalized();
  });
  return normals;
}

/// Axes of a face's plane: along its first edge, and across.
Eigen::Matrix<double, 3, 2> face_axes(const Mesh& mesh, Index face) {
  const Triangle& t = mesh.triangles()[face];
  const Vec3 x = (mesh.position(t[1]) - mesh.position(t[0])).normalized();
  const Vec3 normal = x.cross(mesh.position(t[2]) - mesh.position(t[0])).normalized();
  Eigen::Matrix<double, 3, 2> axes;
  axes << x, normal.cross(x);
  return axes;
}

/// The symmetric 2 x 2 matrix that takes the edges nearest to the differences of the normals at their ends.
Eigen::Matrix2d operator_of_face(const Mesh& mesh, Index face, const Eigen::Matrix<double, 3, 2>& axes,
                                 const std::vector<Vec3>& normals) {
  const Triangle& t = mesh.triangles()[face];
  Eigen::Matrix3d normal_equations = Eigen::Matrix3d::Zero();
  Vec3 right = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    const Index a = t[i], b = t[(i + 1) % 3];
    const double length = mesh.length(3 * face + i);
    const Vec2 edge = axes.transpose() * (mesh.position(b) - mesh.position(a)) / length;
    const Vec2 change = axes.transpose() * (normals[b] - normals[a]) / length;
    const Vec3 rows[2] = {{edge.x(), edge.y(), 0}, {0, edge.x(), edge.y()}};
    for (int k = 0; k < 2; ++k) {
      normal_equations += rows[k] * rows[k].transpose();
      right += rows[k] * change[k];
    }
  }
  const Vec3 solution = normal_equations.ldlt().solve(right);
  Eigen::Matrix2d result;
  result << solution[0], solution[1], solution[1], solution[2];
  return result;
}

/// Removes what a symmetric operator does along the normal.
Mat3 tangential(const Mat3& value, const Vec3& normal) {
  const Mat3 projection = Mat3::Identity() - normal * normal.transpose();
  return projection * value * projection;
}

}  // namespace

ShapeOperator shape_operator(const Mesh& mesh, const JobStage& stage) {
  mesh.require_space("curvature");
  ShapeOperator result{vertex_normals(mesh), std::vector<Mat3>(mesh.vertex_count())};
  std::vector<Mat3> of_faces(mesh.face_count());
  for_rows(0, mesh.face_count(), 0, [&](Index f) {
    if (f % k_rows_a_block == 0) stage.check();
    const auto axes = face_axes(mesh, f);
    of_faces[f] = axes * operator_of_face(mesh, f, axes, result.normals) * axes.transpose();
  });
  for_rows(0, mesh.vertex_count(), 0, [&](Index v) {
    Mat3 sum = Mat3::Zero();
    double area = 0;
    for_fan(mesh, v, [&](Index h) {
      sum += mesh.face_area(Mesh::face_of(h)) * of_faces[Mesh::face_of(h)];
      area += mesh.face_area(Mesh::face_of(h));
    });
    result.operators[v] = tangential(sum / area, result.normals[v]);
  });
  return result;
}

std::vector<FaceBending> bending_of_faces(const Mesh& mesh, const ShapeOperator& shape) {
  std::vector<FaceBending> result(mesh.face_count());
  for_rows(0, mesh.face_count(), 0, [&](Index f) {
    const auto axes = face_axes(mesh, f);
    const Triangle& t = mesh.triangles()[f];
    const Mat3 mean = (shape.operators[t[0]] + shape.operators[t[1]] + shape.operators[t[2]]) / 3;
    const Eigen::Matrix2d flat = axes.transpose() * mean * axes;
    result[f] = {{flat(0, 0) - flat(1, 1), 2 * flat(0, 1)}, flat.trace()};
  });
  return result;
}

PrincipalCurvatures principal_curvatures(const Mesh& mesh, Job* job) {
  const JobStage stage(job, "Measuring curvature");
  const ShapeOperator shape = shape_operator(mesh, stage);
  stage.update(0.8);
  const std::size_t count = mesh.vertex_count();
  PrincipalCurvatures result{std::vector<double>(count), std::vector<double>(count), std::vector<Vec3>(count)};
  for_rows(0, mesh.vertex_count(), 0, [&](Index v) {
    if (v % k_rows_a_block == 0) stage.check();
    const Vec3 x = shape.normals[v].unitOrthogonal();
    Eigen::Matrix<double, 3, 2> axes;
    axes << x, shape.normals[v].cross(x);
    const Eigen::Matrix2d flat = axes.transpose() * shape.operators[v] * axes;
    const double mean = 0.5 * flat.trace(), half = hypotenuse(0.5 * (flat(0, 0) - flat(1, 1)), flat(0, 1));
    const double angle = 0.5 * std::atan2(2 * flat(0, 1), flat(0, 0) - flat(1, 1));
    result.smallest[v] = mean - half;
    result.largest[v] = mean + half;
    result.direction[v] = axes * Vec2(std::cos(angle), std::sin(angle));
  });
  stage.update(1);
  return result;
}

}  // namespace saddleback
