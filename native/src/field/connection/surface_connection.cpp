#include "field/connection/surface_connection.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "field/linear/row_blocks.h"

namespace saddleback {
namespace {

/// Cotangent of the angle at h's apex.
double apex_cotangent(const Mesh& mesh, Index h) {
  const auto [from, to, apex] = mesh.corners(h);
  const Vec3 a = from - apex, b = to - apex;
  return a.dot(b) / a.cross(b).norm();
}

}  // namespace

double chart_angle(const Mesh& mesh, Index h) {
  const Index first = h - h % 3;
  if (h % 3 == 0) return 0;
  return h % 3 == 1 ? std::numbers::pi - mesh.corner_angle(first + 1) : std::numbers::pi + mesh.corner_angle(first);
}

SurfaceConnection surface_connection(const Mesh& mesh, const JobStage& stage) {
  SurfaceConnection result{UnsetArray<double>(mesh.halfedge_count()), UnsetArray<double>(mesh.halfedge_count())};
  for_rows(0, mesh.halfedge_count(), 0, [&](Index h) {
    if (h % k_rows_a_block == 0) stage.check();
    const Index twin = mesh.twin(h);
    if (twin == k_none) result.transport[h] = 0, result.weight[h] = 1;
    if (twin < h) return;
    const double turn = chart_angle(mesh, twin) + std::numbers::pi - chart_angle(mesh, h);
    result.transport[h] = std::remainder(turn, 2 * std::numbers::pi);
    result.transport[twin] = -result.transport[h];
    const double weight = 0.5 * (apex_cotangent(mesh, h) + apex_cotangent(mesh, twin));
    result.weight[h] = result.weight[twin] = std::clamp(weight, 1 / k_weight_range, k_weight_range);
  });
  return result;
}

}  // namespace saddleback
