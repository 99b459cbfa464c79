#include "geodesics/unfolding/needles.h"

#include <algorithm>

namespace saddleback {

bool has_needles(const Mesh& mesh) {
  constexpr Index k_samples = 4096;
  constexpr double k_long = 20, k_share = 0.1;
  const Index stride = std::max<Index>(1, mesh.face_count() / k_samples);
  double needles = 0, count = 0;
  for (Index face = 0; face < mesh.face_count(); face += stride) {
    const double longest = std::max({mesh.length(3 * face), mesh.length(3 * face + 1), mesh.length(3 * face + 2)});
    needles += longest * longest > 2 * k_long * mesh.face_area(face);
    ++count;
  }
  return needles > k_share * count;
}

double needle_factor(const Mesh& mesh) {
  constexpr double k_longer = 6;
  return has_needles(mesh) ? k_longer : 1;
}

}  // namespace saddleback
