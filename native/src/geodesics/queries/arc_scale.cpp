#include "geodesics/queries/arc_scale.h"

#include <algorithm>
#include <limits>

namespace saddleback {
namespace {

constexpr Index k_most_sampled = 4096;

}  // namespace

double shortest_arcs_below(const ArcRows& arcs, double share) {
  const Index count = arcs.node_count(), stride = std::max<Index>(1, count / k_most_sampled);
  std::vector<double> shortest;
  for (Index node = 0; node < count; node += stride) {
    double least = std::numeric_limits<double>::infinity();
    for (std::int64_t arc = arcs.first(node); arc < arcs.first(node + 1); ++arc)
      least = std::min(least, arcs.length(arc));
    shortest.push_back(least);
  }
  const auto chosen = shortest.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(shortest.size() - 1));
  std::nth_element(shortest.begin(), chosen, shortest.end());
  return *chosen;
}

}  // namespace saddleback
