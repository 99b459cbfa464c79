#include "tessellation/relaxation/removable_sites.h"

#include <algorithm>
#include <array>
#include <tuple>

#include "tessellation/cells/cell_topology.h"

namespace saddleback {
namespace {

/// The pairs and triples of cells that meet. Beyond the mesh's boundary lies one more cell, so that the dual has none.
class Neighborhoods {
 public:
  explicit Neighborhoods(const GeodesicVoronoi& cells) : neighbors_(cells.sites.size() + 1) {
    const auto outside = static_cast<Index>(cells.sites.size());
    for (const auto& [a, b] : cells.edge_cells) join(a, b);
    const PointStars stars(cells);
    for (const Index point : cells.branch_points) add_triples(cells_around(stars, point));
    for (Index point = 0; point < static_cast<Index>(cells.points.size()); ++point) {
      const auto rays = stars.rays(point);
      if (rays.size() != 1) continue;
      join(rays[0].left, outside);
      join(rays[0].right, outside);
      add_triples({rays[0].left, rays[0].right, outside});
    }
    for (std::vector<Index>& all : neighbors_) {
      std::ranges::sort(all);
      all.erase(std::ranges::unique(all).begin(), all.end());
    }
    std::ranges::sort(triples_);
  }

  const std::vector<Index>& of(Index cell) const { return neighbors_[cell]; }

  /// Fewest cells, among them this one, that each meet the next without what lies between being filled: 3, 4, or 5 for
  /// more than 4.
  int way_round(Index cell) const {
    const std::vector<Index>& around = of(cell);
    int least = 5;
    for (std::size_t i = 0; i < around.size(); ++i) {
      for (std::size_t j = i + 1; j < around.size(); ++j) {
        const Index a = around[i], b = around[j];
        if (meet(a, b)) {
          if (!meet_in_one_point(cell, a, b)) return 3;
        } else if (meet_beyond(cell, a, b)) {
          least = 4;
        }
      }
    }
    return least;
  }

 private:
  void join(Index a, Index b) {
    if (a == b) return;
    neighbors_[a].push_back(b);
    neighbors_[b].push_back(a);
  }
  /// Adds the triples of the cells about a point: where more than three meet, any three do.
  void add_triples(const std::vector<Index>& around) {
    for (std::size_t i = 0; i < around.size(); ++i) {
      for (std::size_t j = i + 1; j < around.size(); ++j) {
        for (std::size_t k = j + 1; k < around.size(); ++k) {
          std::array<Index, 3> triple{around[i], around[j], around[k]};
          std::ranges::sort(triple);
          triples_.push_back(triple);
        }
      }
    }
  }
  bool meet(Index a, Index b) const { return std::ranges::binary_search(of(a), b); }
  bool meet_in_one_point(Index a, Index b, Index c) const {
    std::array<Index, 3> triple{a, b, c};
    std::ranges::sort(triple);
    return std::ranges::binary_search(triples_, triple);
  }
  /// Tells whether two neighbors of a cell meet a fourth one that does not meet it.
  bool meet_beyond(Index cell, Index a, Index b) const {
    const auto outside = static_cast<Index>(neighbors_.size()) - 1;
    return std::ranges::any_of(of(a == outside ? b : a), [&](Index other) {
      return other != cell && meet(other, a == outside ? a : b) && !meet(other, cell);
    });
  }

  std::vector<std::vector<Index>> neighbors_;
  std::vector<std::array<Index, 3>> triples_;
};

}  // namespace

std::vector<Index> spare_sites(const GeodesicVoronoi& cells, std::span<const CellMoments> moments,
                               std::span<const std::uint8_t> is_needed, std::size_t count) {
  constexpr std::size_t k_least_neighbors = 4;  // of three neighbors, two triangles would be left, one on the other
  const Neighborhoods neighborhoods(cells);
  std::vector<std::tuple<int, double, Index>> candidates;
  for (Index site = 0; site < static_cast<Index>(cells.sites.size()); ++site) {
    if (is_needed[site] || neighborhoods.of(site).size() < k_least_neighbors) continue;
    candidates.emplace_back(-neighborhoods.way_round(site), moments[site].energy, site);
  }
  std::ranges::sort(candidates);
  const auto outside = static_cast<Index>(cells.sites.size());
  std::vector<std::uint8_t> beside_chosen(cells.sites.size() + 1, 0);
  std::vector<Index> chosen;
  for (const auto& [way_round, energy, site] : candidates) {
    if (chosen.size() == count) break;
    const std::vector<Index>& around = neighborhoods.of(site);
    if (std::ranges::any_of(around, [&](Index other) { return beside_chosen[other] != 0; })) continue;
    for (const Index other : around)
      if (other != outside) beside_chosen[other] = 1;
    beside_chosen[site] = 1;
    chosen.push_back(site);
  }
  return chosen;
}

}  // namespace saddleback
