#include "field/connection/untangle_turns.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>

namespace saddleback {

void untangle_turns(const Mesh& mesh, int symmetry, const std::vector<bool>& fixed, std::vector<double>& angles,
                    std::vector<double>& turns) {
  constexpr double k_share = 0.9;        // of what directions can tell
  constexpr std::size_t k_visits = 400;  // for each sharp edge at the start; most need a few
  const double limit = k_share * std::numbers::pi / symmetry;
  std::deque<Index> waiting;
  for (Index h = 0; h < mesh.halfedge_count(); ++h)
    if (std::abs(turns[h]) > limit) waiting.push_back(Mesh::face_of(h));
  for (std::size_t visits = k_visits * waiting.size(); visits > 0 && !waiting.empty(); --visits) {
    const Index face = waiting.front();
    waiting.pop_front();
    if (fixed[face]) continue;
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      if (mesh.twin(h) == k_none) continue;
      least = std::min(least, turns[h]);
      most = std::max(most, turns[h]);
    }
    if (!(std::max(-least, most) > limit)) continue;
    const double shift = 0.5 * (least + most);
    angles[face] += shift;
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      const Index twin = mesh.twin(h);
      if (twin == k_none) continue;
      turns[h] -= shift;
      turns[twin] = -turns[h];
      if (std::abs(turns[h]) > limit) waiting.push_back(Mesh::face_of(twin));
    }
  }
}

}  // namespace saddleback
