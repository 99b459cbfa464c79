#include "saddleback/tessellation/triangle_quality.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "saddleback/error.h"

namespace saddleback {
namespace {

void check(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (!vertices[v].allFinite())
      throw InputError(message("vertices: vertex ", v, " has a coordinate that is not finite"));
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const Index v : triangles[t]) {
      if (v >= 0 && v < static_cast<Index>(vertices.size())) continue;
      throw InputError(message("triangles: triangle ", t, " names vertex ", v, ", but there are ", vertices.size()));
    }
  }
}

int exponent_of(double value) {
  int exponent = 0;
  std::frexp(value, &exponent);
  return exponent;
}

/// The edges as vectors of lengths about 1, scaled by powers of 2: nothing overflows or underflows, and roundings are
/// those of any other size.
std::array<Vec3, 3> scaled_edges(const std::array<Vec3, 3>& corner) {
  const auto scaled = [](const std::array<Vec3, 3>& vectors) {
    double most = 0;
    for (const Vec3& v : vectors) most = std::max(most, v.cwiseAbs().maxCoeff());
    std::array<Vec3, 3> result;
    for (int i = 0; i < 3; ++i)
      result[i] = vectors[i].unaryExpr([exponent = exponent_of(most)](double x) { return std::ldexp(x, -exponent); });
    return result;
  };
  const std::array<Vec3, 3> near = scaled(corner);
  return scaled({near[1] - near[0], near[2] - near[1], near[0] - near[2]});
}

void measure(const std::array<Vec3, 3>& corner, TriangleQuality& out) {
  const std::array<Vec3, 3> edge = scaled_edges(corner);
  double perimeter = 0, longest = 0, least = std::numbers::pi, greatest = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 &a = edge[i], b = -edge[(i + 2) % 3];
    const double length = a.norm(), angle = std::atan2(a.cross(b).norm(), a.dot(b));
    perimeter += length;
    longest = std::max(longest, length);
    least = std::min(least, angle);
    greatest = std::max(greatest, angle);
  }
  // 6 S / (sqrt(3) (perimeter / 2) h), S being half the length of the edges' product.
  const double scale = std::sqrt(3.0) * perimeter * longest;
  out.quality.push_back(scale > 0 ? 6 * edge[0].cross(edge[2]).norm() / scale : 0);
  out.least_angle.push_back(least);
  out.greatest_angle.push_back(greatest);
}

void count_edges(std::span<const Triangle> triangles, TriangleQuality& out) {
  std::vector<std::array<Index, 2>> edges;
  for (const Triangle& t : triangles) {
    for (int i = 0; i < 3; ++i) edges.push_back({std::min(t[i], t[(i + 1) % 3]), std::max(t[i], t[(i + 1) % 3])});
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end] == edges[begin]) ++end;
    for (const Index v : edges[begin]) {
      ++out.valence[v];
      if (end - begin == 1) out.at_boundary[v] = 1;
    }
  }
}

}  // namespace

TriangleQuality triangle_quality(std::span<const Vec3> vertices, std::span<const Triangle> triangles, Job* job) {
  const JobStage stage(job, "Measuring triangles");
  check(vertices, triangles);
  TriangleQuality result;
  result.valence.assign(vertices.size(), 0);
  result.at_boundary.assign(vertices.size(), 0);
  for (const Triangle& t : triangles) {
    stage.check();
    measure({vertices[t[0]], vertices[t[1]], vertices[t[2]]}, result);
  }
  stage.update(0.5);
  count_edges(triangles, result);
  stage.update(1);
  std::size_t used = 0, irregular = 0;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (result.valence[v] == 0) continue;
    ++used;
    irregular += result.valence[v] != (result.at_boundary[v] ? 4 : 6);
  }
  result.irregular = used > 0 ? static_cast<double>(irregular) / static_cast<double>(used) : 0;
  return result;
}

}  // namespace saddleback
