#pragma once
// The sites as all circles see them: checked, scaled into the range of exact arithmetic, without duplicates, along a
// space-filling curve.

#include <cstdint>
#include <span>

#include "saddleback/job.h"
#include "saddleback/support/large_array.h"
#include "saddleback/types.h"

namespace saddleback::voronoi2d {

/// Distinct sites in an order in which neighbors in the plane are near each other. It depends on the sites alone; a
/// site's place in it is its rank, by which ties are decided and results are numbered.
struct OrderedSites {
  LargeArray<double> x, y;           ///< by rank, times `scale`
  LargeArray<Index> original;        ///< by rank: the index given by the caller, the smallest of equal sites
  LargeArray<Index> rank_of;         ///< by index: the rank of the site or of its equal
  LargeArray<double> weights;        ///< by rank, times the square of `scale`; none: all alike
  LargeArray<std::uint32_t> places;  ///< by rank: two bits for each halving of the squares, never falling
  double scale = 1;                  ///< a power of two

  Index count() const { return static_cast<Index>(x.size()); }
  /// The smallest index of the sites that are equal to this one.
  Index site_of(std::size_t index) const { return original[rank_of[index]]; }
};

/// Refuses more sites than there are numbers of 32 bits for the half-edges of their triangles. \throw InputError
void check_site_count(std::size_t count);

/// `threads`: 0: all cores. \throw InputError for too many sites, a coordinate that is not finite, and for coordinates
/// of too different size. O(n log n).
OrderedSites order_sites(std::span<const Vec2> sites, int threads, const JobStage& stage);

/// Returns by index: the smallest index of an equal site.
LargeArray<Index> smallest_equals(const OrderedSites& sites, int threads, const JobStage& stage);

LargeArray<Vec2> copy_of(std::span<const Vec2> sites, int threads, const JobStage& stage);

}  // namespace saddleback::voronoi2d
