#include "geodesics/unfolding/common_length.h"

#include <algorithm>
#include <vector>

namespace saddleback {

double common_length(const Mesh& mesh) {
  constexpr Index k_sample = 1000;
  std::vector<double> lengths;
  for (Index h = 0; h < mesh.halfedge_count(); h += 1 + mesh.halfedge_count() / k_sample)
    lengths.push_back(mesh.length(h));
  const auto middle = lengths.begin() + std::ssize(lengths) / 2;
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

}  // namespace saddleback
