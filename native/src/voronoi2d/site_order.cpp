// Places along a Hilbert curve of 2^16 x 2^16 squares over the sites' box, sorted by radix; sites that share a square
// are put in order by a curve over their own box, and so on, which follows clusters of any size.

#include "voronoi2d/site_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "saddleback/error.h"

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

constexpr int k_bits = 16;

// Hilbert's curve, two bits of each axis at a time: state, then bits of x and y, to bits of the place and a new state.
struct CurveTable {
  struct Step {
    std::uint8_t place, state;
  };
  std::array<Step, 4 * 16> steps{};

  constexpr CurveTable() {
    for (unsigned state = 0; state < 4; ++state) {
      for (unsigned xy = 0; xy < 16; ++xy) {
        unsigned s = state, place = 0;
        for (int bit = 1; bit >= 0; --bit) {
          const unsigned x = (xy >> (2 + bit)) & 1, y = (xy >> bit) & 1;
          const unsigned u = s & 2 ? 1 - x : x, v = s & 2 ? 1 - y : y;  // state: 1 swaps the axes, 2 turns around
          const unsigned p = s & 1 ? v : u, q = s & 1 ? u : v;
          place = 4 * place + (3 * p ^ q);
          if (q == 0) s ^= p == 1 ? 3 : 1;
        }
        steps[16 * state + xy] = {static_cast<std::uint8_t>(place), static_cast<std::uint8_t>(s)};
      }
    }
  }
};
constexpr CurveTable k_curve;

std::uint32_t place_on_curve(std::uint32_t x, std::uint32_t y) {
  std::uint32_t place = 0;
  unsigned state = 0;
  for (int shift = k_bits - 2; shift >= 0; shift -= 2) {
    const auto step = k_curve.steps[16 * state + 4 * ((x >> shift) & 3) + ((y >> shift) & 3)];
    place = 16 * place + step.place;
    state = step.state;
  }
  return place;
}

struct Keyed {
  std::uint32_t place;
  Index index;
};

// Stable, least digit first.
void radix_sort(LargeArray<Keyed>& items, LargeArray<Keyed>& other) {
  constexpr int k_digit = 11;
  constexpr std::size_t k_values = std::size_t{1} << k_digit;
  other.resize(items.size());
  for (int shift = 0; shift < 2 * k_bits; shift += k_digit) {
    std::array<std::size_t, k_values + 1> begin{};
    for (const Keyed& item : items) ++begin[((item.place >> shift) & (k_values - 1)) + 1];
    for (std::size_t i = 0; i < k_values; ++i) begin[i + 1] += begin[i];
    for (const Keyed& item : items) other[begin[(item.place >> shift) & (k_values - 1)]++] = item;
    items.swap(other);
  }
}

struct Box {
  double low[2] = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  double high[2] = {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
};

class Sorter {
 public:
  Sorter(std::span<const Vec2> sites) : sites_(sites) {}

  /// Sorts indices along the curve over their box; equal sites end up side by side, the smallest index first.
  void sort(std::span<Keyed> items) {
    constexpr std::size_t k_few = 48;
    if (items.size() <= k_few || !place(items)) {
      std::sort(items.begin(), items.end(), [&](const Keyed& a, const Keyed& b) { return less(a.index, b.index); });
      return;
    }
    std::sort(items.begin(), items.end(), [](const Keyed& a, const Keyed& b) {
      return a.place != b.place ? a.place < b.place : a.index < b.index;
    });
    sort_runs(items);
  }

  void sort_runs(std::span<Keyed> items) {
    for (std::size_t begin = 0, end; begin < items.size(); begin = end) {
      for (end = begin + 1; end < items.size() && items[end].place == items[begin].place;) ++end;
      if (end - begin > 1) sort(items.subspan(begin, end - begin));
    }
  }

  /// Fills in the places; false when all sites are in one point.
  bool place(std::span<Keyed> items) {
    Box box;
    for (const Keyed& item : items) {
      for (int k = 0; k < 2; ++k) {
        box.low[k] = std::min(box.low[k], sites_[item.index][k]);
        box.high[k] = std::max(box.high[k], sites_[item.index][k]);
      }
    }
    // Halves, since the width of the box may be beyond the doubles.
    const double width = std::max(0.5 * box.high[0] - 0.5 * box.low[0], 0.5 * box.high[1] - 0.5 * box.low[1]);
    if (!(width > 0)) return false;
    constexpr double k_squares = 1 << k_bits;
    for (Keyed& item : items) {
      std::uint32_t square[2];
      for (int k = 0; k < 2; ++k) {
        const double share = (0.5 * sites_[item.index][k] - 0.5 * box.low[k]) / width;
        square[k] = static_cast<std::uint32_t>(std::min(share * k_squares, k_squares - 1));
      }
      item.place = place_on_curve(square[0], square[1]);
    }
    return true;
  }

 private:
  bool less(Index a, Index b) const {
    const Vec2 &p = sites_[a], &q = sites_[b];
    if (p.x() != q.x()) return p.x() < q.x();
    return p.y() != q.y() ? p.y() < q.y() : a < b;
  }
  std::span<const Vec2> sites_;
};

}  // namespace

OrderedSites order_sites(std::span<const Vec2> sites, const JobStage& stage) {
  OrderedSites result;
  const Range range = check(sites);
  result.scale = scale_for(sites, range);
  stage.update(0.1);

  LargeArray<Keyed> items(sites.size()), other;
  for (std::size_t i = 0; i < items.size(); ++i) items[i] = {0, static_cast<Index>(i)};
  Sorter sorter(sites);
  if (items.size() > 1 && sorter.place(items)) {
    stage.update(0.3);
    radix_sort(items, other);
    stage.update(0.6);
  }
  LargeArray<std::uint32_t> places(items.size());  // the runs' own curves overwrite theirs
  for (std::size_t i = 0; i < items.size(); ++i) places[i] = items[i].place;
  sorter.sort_runs(items);
  stage.update(0.8);

  result.site_of.resize(sites.size());
  result.original.reserve(sites.size());
  result.x.reserve(sites.size());
  result.y.reserve(sites.size());
  result.places.reserve(sites.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    const Keyed& item = items[i];
    const double x = sites[item.index].x() * result.scale, y = sites[item.index].y() * result.scale;
    if (result.x.empty() || result.x.back() != x || result.y.back() != y) {
      result.x.push_back(x);
      result.y.push_back(y);
      result.original.push_back(item.index);
      result.places.push_back(places[i]);
    }
    result.site_of[item.index] = result.original.back();
  }
  stage.update(1);
  return result;
}

}  // namespace saddleback::voronoi2d
