#include "geodesics/unfolding/common_length.h"

#include <algorithm>
#include <vector>

namespace saddleback {

double edge_length_at(const Mesh& mesh, double share) {
  constexpr Index k_sample = 1000;
  std::vector<double> lengths;
  for (Index h = 0; h < mesh.halfedge_count(); h += 1 + mesh.halfedge_count() / k_sample)
    lengths.push_back(mesh.length(h));
  const auto chosen = lengths.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(lengths.size()));
  std::nth_element(lengths.begin(), chosen, lengths.end());
  return *chosen;
}

double common_length(const Mesh& mesh) { return edge_length_at(mesh, 0.5); }

}  // namespace saddleback
