#include "voronoi2d/sites/site_weights.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "saddleback/error.h"

namespace saddleback::voronoi2d {

void check_weights(std::span<const Vec2> sites, std::span<const double> weights) {
  if (weights.size() != sites.size())
    throw InputError(message("weights: wanted one for each of ", sites.size(), " sites, got ", weights.size()));
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (!std::isfinite(weights[i]))
      throw InputError(message("weights: weight ", i, " is ", weights[i], ", wanted a finite number"));
}

Heaviest heaviest_by_place(const OrderedSites& ordered, std::span<const double> weights) {
  const Index count = static_cast<Index>(weights.size());
  Heaviest result{ordered.original, LargeArray<std::uint8_t>(count, 0)};
  if (ordered.count() == count) return result;
  for (Index i = 0; i < count; ++i) {
    Index& best = result.original[ordered.rank_of[i]];
    if (weights[i] > weights[best]) best = i;
  }
  for (Index i = 0; i < count; ++i)
    result.is_hidden[i] = static_cast<std::uint8_t>(weights[i] < weights[result.original[ordered.rank_of[i]]]);
  return result;
}

LargeArray<Index> smallest_equal(const OrderedSites& ordered, std::span<const double> weights) {
  const Index count = static_cast<Index>(weights.size());
  LargeArray<Index> site_of(count);
  std::iota(site_of.begin(), site_of.end(), 0);
  if (ordered.count() == count) return site_of;
  std::vector<Index> shared;  // sites that are not alone at their place
  std::vector<bool> is_shared(ordered.count(), false);
  for (Index i = 0; i < count; ++i)
    if (ordered.site_of(i) != i) is_shared[ordered.rank_of[i]] = true;
  for (Index i = 0; i < count; ++i)
    if (is_shared[ordered.rank_of[i]]) shared.push_back(i);
  const auto same = [&](Index a, Index b) {
    return ordered.rank_of[a] == ordered.rank_of[b] && weights[a] == weights[b];
  };
  std::sort(shared.begin(), shared.end(), [&](Index a, Index b) {
    if (ordered.rank_of[a] != ordered.rank_of[b]) return ordered.rank_of[a] < ordered.rank_of[b];
    return weights[a] != weights[b] ? weights[a] < weights[b] : a < b;
  });
  for (std::size_t k = 1; k < shared.size(); ++k)
    if (same(shared[k - 1], shared[k])) site_of[shared[k]] = site_of[shared[k - 1]];
  return site_of;
}

}  // namespace saddleback::voronoi2d
