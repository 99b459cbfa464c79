#include "geodesics/unfolding/angle_defect.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace saddleback {

double mean_angle_defect(const Mesh& mesh) {
  constexpr Index k_samples = 4096;
  const Index stride = std::max<Index>(1, mesh.vertex_count() / k_samples);
  double sum = 0, count = 0;
  for (Index v = 0; v < mesh.vertex_count(); v += stride) {
    if (mesh.is_boundary(v)) continue;
    sum += std::abs(mesh.total_angle(v) - 2 * std::numbers::pi);
    ++count;
  }
  return sum / std::max(1.0, count);
}

double edges_until_bent(const Mesh& mesh) {
  constexpr double k_edges = 12.5, k_power = 0.4, k_least_defect = 1e-6;
  return k_edges * std::pow(std::max(k_least_defect, mean_angle_defect(mesh)), -k_power);
}

}  // namespace saddleback
