#include "mesh/tables/face_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>

namespace saddleback {
namespace {

double twice_area(const std::array<Vec3, 3>& edge, const std::array<double, 3>& length) {
  const int longest = static_cast<int>(std::max_element(length.begin(), length.end()) - length.begin());
  return edge[(longest + 1) % 3].cross(edge[(longest + 2) % 3]).norm();
}

/// The result is not a number where there is no such triangle.
double twice_area(std::span<const double, 3> length) {
  std::array<double, 3> l{length[0], length[1], length[2]};
  std::ranges::sort(l, std::greater());
  const auto [a, b, c] = l;
  return 0.5 * std::sqrt((a + (b + c)) * (a + (b - c))) * std::sqrt((c - (a - b)) * (c + (a - b)));
}

}  // namespace

FaceShape measure_face(const Vec3& a, const Vec3& b, const Vec3& c) {
  const std::array<Vec3, 3> edge{Vec3(b - a), Vec3(c - b), Vec3(a - c)};
  FaceShape shape;
  for (int i = 0; i < 3; ++i) shape.length[i] = edge[i].norm();
  const double twice = twice_area(edge, shape.length);
  for (int i = 0; i < 3; ++i) shape.angle[i] = std::atan2(twice, -edge[i].dot(edge[(i + 2) % 3]));
  shape.area = 0.5 * twice;
  return shape;
}

FaceShape measure_face(std::span<const double, 3> length) {
  FaceShape shape{{length[0], length[1], length[2]}, {}, 0};
  const double twice = twice_area(length);
  for (int i = 0; i < 3; ++i) {
    const auto [small, large] = std::minmax(length[i], length[(i + 2) % 3]);
    const double opposite = length[(i + 1) % 3];
    shape.angle[i] = std::atan2(twice, 0.5 * (small * small + (large - opposite) * (large + opposite)));
  }
  shape.area = 0.5 * twice;
  return shape;
}

bool is_degenerate_face(std::span<const double, 3> length) {
  const double longest = std::ranges::max(length);
  return !(longest > k_smallest_edge) || !(twice_area(length) > k_degenerate_height * longest * longest);
}

bool is_degenerate_face(const Vec3& a, const Vec3& b, const Vec3& c) {
  const std::array<Vec3, 3> edge{Vec3(b - a), Vec3(c - b), Vec3(a - c)};
  const std::array<double, 3> length{edge[0].norm(), edge[1].norm(), edge[2].norm()};
  const double longest = *std::max_element(length.begin(), length.end());
  return !(longest > k_smallest_edge) || !(twice_area(edge, length) > k_degenerate_height * longest * longest);
}

}  // namespace saddleback
