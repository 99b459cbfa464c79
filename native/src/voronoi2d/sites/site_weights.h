#pragma once
// Weights of sites, and what they decide where several sites share a place.

#include <cstdint>
#include <span>

#include "saddleback/support/large_array.h"
#include "saddleback/types.h"

#include "voronoi2d/sites/site_order.h"

namespace saddleback::voronoi2d {

/// \throw InputError for a wrong number of weights or one that is not finite.
void check_weights(std::span<const Vec2> sites, std::span<const double> weights);

/// Finds at each place the heaviest site, of equal ones the smallest index. `ordered` knows the places.
struct Heaviest {
  LargeArray<Index> original;          ///< by rank of the place
  LargeArray<std::uint8_t> is_hidden;  ///< by index
};
Heaviest heaviest_by_place(const OrderedSites& ordered, std::span<const double> weights);

/// Returns by index: of sites at one place with one weight the smallest index, which stands for all.
LargeArray<Index> smallest_equal(const OrderedSites& ordered, std::span<const double> weights);

}  // namespace saddleback::voronoi2d
