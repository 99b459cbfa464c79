#include "voronoi2d/site_order.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "saddleback/error.h"

#include "voronoi2d/curve_order.h"

namespace saddleback::voronoi2d {
namespace {

// Determinants of four factors must neither overflow nor lose bits below the smallest double.
constexpr int k_highest_exponent = 250, k_lowest_bit = -268;

// Exponent of the lowest bit that is set.
int lowest_bit(double value) {
  int exponent;
  const double mantissa = std::frexp(std::fabs(value), &exponent);
  return exponent - 53 + std::countr_zero(static_cast<std::uint64_t>(std::ldexp(mantissa, 53)));
}

struct Range {
  double smallest = std::numeric_limits<double>::infinity(), largest = 0;  ///< magnitudes other than 0
};

Range check(std::span<const Vec2> sites) {
  Range range;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    for (int k = 0; k < 2; ++k) {
      const double value = std::fabs(sites[i][k]);
      if (!std::isfinite(value))
        throw InputError(
            message("sites: coordinate ", k, " of site ", i, " is ", sites[i][k], ", wanted a finite number"));
      if (value != 0 && value < range.smallest) range.smallest = value;
      if (value > range.largest) range.largest = value;
    }
  }
  return range;
}

// 1 unless the coordinates are outside of what exact arithmetic can take.
double scale_for(std::span<const Vec2> sites, const Range& range) {
  if (range.largest == 0) return 1;
  const bool fits =
      range.largest < std::ldexp(1, k_highest_exponent) && range.smallest >= std::ldexp(1, k_lowest_bit + 52);
  if (fits) return 1;
  int highest;
  std::frexp(range.largest, &highest);
  const int shift = std::clamp(k_highest_exponent - highest, -1022, 1023);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    for (int k = 0; k < 2; ++k) {
      const double value = sites[i][k];
      if (value != 0 && lowest_bit(value) + shift < k_lowest_bit)
        throw InputError(message("sites: coordinate ", k, " of site ", i, " is ", value,
                                 ", too fine to be told exactly from others as large as ", range.largest));
    }
  }
  return std::ldexp(1, shift);
}

}  // namespace

OrderedSites order_sites(std::span<const Vec2> sites, const JobStage& stage) {
  OrderedSites result;
  const Range range = check(sites);
  result.scale = scale_for(sites, range);
  stage.update(0.05);

  const LargeArray<Placed> items = curve_order(sites, stage.part(0.05, 0.8));

  result.site_of.resize(sites.size());
  result.original.reserve(sites.size());
  result.x.reserve(sites.size());
  result.y.reserve(sites.size());
  result.places.reserve(sites.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    if ((i & 0xffff) == 0) stage.update(0.8 + 0.2 * static_cast<double>(i) / static_cast<double>(items.size()));
#ifdef __GNUC__
    constexpr std::size_t k_ahead = 32;  // the sites lie anywhere in memory: asked for before they are needed
    if (i + k_ahead < items.size()) {
      __builtin_prefetch(&sites[items[i + k_ahead].index]);
      __builtin_prefetch(&result.site_of[items[i + k_ahead].index], 1);
    }
#endif
    const Placed& item = items[i];
    const double x = sites[item.index].x() * result.scale, y = sites[item.index].y() * result.scale;
    if (result.x.empty() || result.x.back() != x || result.y.back() != y) {
      result.x.push_back(x);
      result.y.push_back(y);
      result.original.push_back(item.index);
      result.places.push_back(item.place);
    }
    result.site_of[item.index] = result.original.back();
  }
  stage.update(1);
  return result;
}

}  // namespace saddleback::voronoi2d
