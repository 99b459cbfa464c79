#include "voronoi2d/sites/site_order.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "saddleback/error.h"

#include "voronoi2d/sites/curve_order.h"
#include "voronoi2d/sites/for_pieces.h"

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
  bool is_finite = true;

  void add(double value) {
    const double size = std::fabs(value);
    is_finite &= size <= std::numeric_limits<double>::max();
    const double other_than_0 = size > 0 ? size : smallest;
    smallest = other_than_0 < smallest ? other_than_0 : smallest;
    largest = size > largest ? size : largest;
  }
  void add(const Range& other) {
    smallest = std::min(smallest, other.smallest);
    largest = std::max(largest, other.largest);
    is_finite &= other.is_finite;
  }
};

[[noreturn]] void throw_not_finite(std::span<const Vec2> sites) {
  for (std::size_t i = 0; i < sites.size(); ++i)
    for (int k = 0; k < 2; ++k)
      if (!std::isfinite(sites[i][k]))
        throw InputError(
            message("sites: coordinate ", k, " of site ", i, " is ", sites[i][k], ", wanted a finite number"));
  throw Error("sites: not finite, and finite when looked at again");
}

Range check(std::span<const Vec2> sites, int threads, const JobStage& stage) {
  std::vector<Range> ranges(sites.size() / k_piece + 1);
  for_pieces(sites.size(), threads, stage, [&](Index piece, std::size_t begin, std::size_t end) {
    Range along[2];
    for (std::size_t i = begin; i < end; ++i)
      for (int k = 0; k < 2; ++k) along[k].add(sites[i][k]);
    along[0].add(along[1]);
    ranges[piece] = along[0];
  });
  Range all;
  for (const Range& range : ranges) all.add(range);
  if (!all.is_finite) throw_not_finite(sites);
  return all;
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

/// Writes the sites by rank, piece by piece of the items along the curve.
class Gatherer {
 public:
  Gatherer(std::span<const Vec2> sites, const LargeArray<Placed>& items, int threads, OrderedSites& result)
      : sites_(sites), items_(items), threads_(threads), result_(result) {
    const std::size_t count = items.size();
    result.rank_of.resize(count);
    result.original.resize(count);
    result.x.resize(count);
    result.y.resize(count);
    result.places.resize(count);
  }

  void run(const JobStage& stage) {
    std::vector<char> has_equal(items_.size() / k_piece + 1, 0);
    for_pieces(items_.size(), threads_, stage.part(0, 0.9), [&](Index piece, std::size_t begin, std::size_t end) {
      has_equal[piece] = static_cast<char>(gather(begin, end));
    });
    if (std::find(has_equal.begin(), has_equal.end(), 1) != has_equal.end()) leave_out_equal(stage.part(0.9, 1));
  }

 private:
  /// Tells whether some are equal to the one before them.
  bool gather(std::size_t begin, std::size_t end) {
    const std::size_t count = items_.size();
    const Vec2* const sites = sites_.data();
    const Placed* const items = items_.data();
    double *const to_x = result_.x.data(), *const to_y = result_.y.data();
    Index *const original = result_.original.data(), *const rank_of = result_.rank_of.data();
    std::uint32_t* const places = result_.places.data();
    const double scale = result_.scale;
    Vec2 before = begin > 0 ? sites[items[begin - 1].index] : Vec2(NAN, NAN);
    bool has_equal = false;
    for (std::size_t i = begin; i < end; ++i) {
#ifdef __GNUC__
      constexpr std::size_t k_ahead = 32;  // the sites lie anywhere in memory: asked for before they are needed
      const Index later = items[std::min(i + k_ahead, count - 1)].index;
      __builtin_prefetch(&sites[later]);
      __builtin_prefetch(&rank_of[later], 1);
#endif
      const Placed item = items[i];
      const Vec2 site = sites[item.index];
      const bool has_equal_x = site.x() == before.x(), has_equal_y = site.y() == before.y();
      has_equal |= has_equal_x & has_equal_y;
      before = site;
      to_x[i] = site.x() * scale;
      to_y[i] = site.y() * scale;
      original[i] = item.index;
      places[i] = item.key;
      rank_of[item.index] = static_cast<Index>(i);
    }
    return has_equal;
  }

  void leave_out_equal(const JobStage& stage) {
    std::size_t kept = 0;
    OrderedSites& r = result_;
    for (std::size_t i = 0; i < items_.size(); ++i) {
      if (i % k_piece == 0) stage.update(static_cast<double>(i) / static_cast<double>(items_.size()));
      if (kept == 0 || r.x[kept - 1] != r.x[i] || r.y[kept - 1] != r.y[i]) {
        r.x[kept] = r.x[i];
        r.y[kept] = r.y[i];
        r.original[kept] = r.original[i];
        r.places[kept] = r.places[i];
        ++kept;
      }
      r.rank_of[items_[i].index] = static_cast<Index>(kept) - 1;
    }
    r.x.resize(kept);
    r.y.resize(kept);
    r.original.resize(kept);
    r.places.resize(kept);
  }

  std::span<const Vec2> sites_;
  const LargeArray<Placed>& items_;
  int threads_;
  OrderedSites& result_;
};

}  // namespace

void check_site_count(std::size_t count) {
  constexpr std::size_t k_most = 250'000'000;  // two triangles each, of four half-edges, and some to close the plane
  if (count > k_most) throw InputError(message("sites: wanted up to ", k_most, ", got ", count));
}

OrderedSites order_sites(std::span<const Vec2> sites, int threads, const JobStage& stage) {
  check_site_count(sites.size());
  OrderedSites result;
  result.scale = scale_for(sites, check(sites, threads, stage.part(0, 0.1)));
  const LargeArray<Placed> items = curve_order(sites, threads, stage.part(0.1, 0.7));
  Gatherer(sites, items, threads, result).run(stage.part(0.7, 1));
  stage.update(1);
  return result;
}

LargeArray<Index> smallest_equals(const OrderedSites& sites, int threads, const JobStage& stage) {
  LargeArray<Index> site_of(sites.rank_of.size());
  const bool are_distinct = sites.original.size() == site_of.size();
  for_pieces(site_of.size(), threads, stage, [&](Index, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) site_of[i] = are_distinct ? static_cast<Index>(i) : sites.site_of(i);
  });
  return site_of;
}

LargeArray<Vec2> copy_of(std::span<const Vec2> sites, int threads, const JobStage& stage) {
  LargeArray<Vec2> copy(sites.size());
  for_pieces(sites.size(), threads, stage, [&](Index, std::size_t begin, std::size_t end) {
    std::copy(sites.data() + begin, sites.data() + end, copy.data() + begin);
  });
  return copy;
}

}  // namespace saddleback::voronoi2d
