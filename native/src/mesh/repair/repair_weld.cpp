// Welding by a grid of hashed cells. Vertices are taken in order and join the nearest earlier one that stays (a leader)
// within the distance, else stay themselves: chains of close vertices cannot run away, and leaders further apart than
// the distance fill a cell of that size with a bounded number, which keeps every search short.

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "mesh/repair/repair_steps.h"

namespace saddleback {
namespace {

using Cell = std::array<double, 3>;

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::uint64_t hash = 0;
    for (const double x : cell) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9e3779b97f4a7c15u;  // + 0.0: -0 is 0
      hash ^= hash >> 32;
    }
    return hash;
  }
};

class LeaderGrid {
 public:
  LeaderGrid(std::span<const Vec3> positions, double distance) : positions_(positions), distance_(distance) {}

  Index leader_near(Index vertex) const {
    const Vec3& p = positions_[vertex];
    const Cell home = cell_of(p);
    const int reach = distance_ > 0 ? 1 : 0;
    Index best = k_none;
    double best_distance = distance_;
    for (int i = -reach; i <= reach; ++i)
      for (int j = -reach; j <= reach; ++j)
        for (int k = -reach; k <= reach; ++k) {
          const auto found = leaders_.find({home[0] + i, home[1] + j, home[2] + k});
          if (found == leaders_.end()) continue;
          for (const Index leader : found->second) {
            const double d = (positions_[leader] - p).norm();
            if (d < best_distance || (d == best_distance && (best == k_none || leader < best))) {
              best = leader;
              best_distance = d;
            }
          }
        }
    return best;
  }

  void add(Index vertex) { leaders_[cell_of(positions_[vertex])].push_back(vertex); }

 private:
  // With no distance the cell is the place itself.
  Cell cell_of(const Vec3& p) const {
    if (distance_ <= 0) return {p[0], p[1], p[2]};
    return {std::floor(p[0] / distance_), std::floor(p[1] / distance_), std::floor(p[2] / distance_)};
  }

  std::span<const Vec3> positions_;
  double distance_;
  std::unordered_map<Cell, std::vector<Index>, CellHash> leaders_;
};

bool before(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

std::vector<Index> weld_exactly(std::span<const Vec3> positions, std::span<const std::uint8_t> used,
                                const JobStage& stage) {
  std::vector<Index> order, cluster(positions.size());
  for (Index v = 0; v < static_cast<Index>(positions.size()); ++v) {
    cluster[v] = v;
    if (used[v]) order.push_back(v);
  }
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    stage.check();
    if (before(positions[a], positions[b])) return true;
    return !before(positions[b], positions[a]) && a < b;
  });
  for (std::size_t i = 1; i < order.size(); ++i)
    if (positions[order[i]] == positions[order[i - 1]]) cluster[order[i]] = cluster[order[i - 1]];
  return cluster;
}

}  // namespace

std::vector<Index> weld_clusters(std::span<const Vec3> positions, std::span<const std::uint8_t> used, double distance,
                                 const JobStage& stage) {
  double largest = 0;
  for (std::size_t v = 0; v < positions.size(); ++v)
    if (used[v]) largest = std::max(largest, positions[v].cwiseAbs().maxCoeff());
  // Below the resolution of the coordinates a distance can only mean the same place.
  constexpr double k_resolution = 0x1p-50;
  if (distance <= largest * k_resolution) return weld_exactly(positions, used, stage);

  LeaderGrid grid(positions, distance);
  std::vector<Index> cluster(positions.size());
  for (Index v = 0; v < static_cast<Index>(positions.size()); ++v) {
    stage.check();
    cluster[v] = v;
    if (!used[v]) continue;
    const Index leader = grid.leader_near(v);
    if (leader == k_none) {
      grid.add(v);
    } else {
      cluster[v] = leader;
    }
  }
  return cluster;
}

}  // namespace saddleback
