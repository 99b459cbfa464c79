// Places along a Hilbert curve of 2^16 x 2^16 squares over the points' box, sorted by radix, as many digits as part
// most points, then those that are left side by side; points that share a square are put in order by a curve over their
// own box, and so on, which follows clusters of any size.

#include "voronoi2d/sites/curve_order.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "support/threads/parallel.h"
#include "voronoi2d/sites/curve_place.h"

namespace saddleback::voronoi2d {
namespace {

constexpr int k_bits = k_curve_bits;

// Hilbert's curve, four bits of each axis at a time: state, then bits of x and y, to bits of the place and a new state.
struct CurveTable {
  static constexpr int k_step = 4;
  static constexpr std::uint32_t k_values = 1u << k_step;
  struct Step {
    std::uint8_t place, state;
  };
  std::array<Step, 4 * k_values * k_values> steps{};

  constexpr CurveTable() {
    for (std::uint32_t state = 0; state < 4; ++state) {
      for (std::uint32_t xy = 0; xy < k_values * k_values; ++xy) {
        std::uint32_t s = state, place = 0;
        for (int bit = k_step - 1; bit >= 0; --bit)
          place = 4 * place + curve_step((xy >> (k_step + bit)) & 1, (xy >> bit) & 1, s);
        steps[k_values * k_values * state + xy] = {static_cast<std::uint8_t>(place), static_cast<std::uint8_t>(s)};
      }
    }
  }
};
constexpr CurveTable k_curve;

/// Works as place_of_square, which a processor takes twice as long for, and a device with no tables at hand less.
constexpr std::uint32_t place_on_curve(std::uint32_t x, std::uint32_t y) {
  constexpr std::uint32_t k_values = CurveTable::k_values, k_mask = k_values - 1;
  std::uint32_t place = 0, state = 0;
  for (int shift = k_bits - CurveTable::k_step; shift >= 0; shift -= CurveTable::k_step) {
    const auto step =
        k_curve.steps[k_values * k_values * state + k_values * ((x >> shift) & k_mask) + ((y >> shift) & k_mask)];
    place = k_values * k_values * place + step.place;
    state = step.state;
  }
  return place;
}
static_assert([] {
  for (std::uint32_t i = 1, square = 1; i <= 1000; ++i) {
    square = square * 1664525u + 1013904223u;  // any
    const std::uint32_t x = square >> k_bits, y = (square ^ i * 40503u) & 0xffffu;
    if (place_on_curve(x, y) != place_of_square(x, y)) return false;
  }
  return true;
}());

struct Box {
  double low[2] = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  double high[2] = {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};

  void add(const Vec2& point) {
    for (int k = 0; k < 2; ++k) {
      low[k] = point[k] < low[k] ? point[k] : low[k];
      high[k] = point[k] > high[k] ? point[k] : high[k];
    }
  }
  void add(const Box& other) {
    for (int k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], other.low[k]);
      high[k] = std::max(high[k], other.high[k]);
    }
  }
  /// Half of the longer side: the whole may be beyond the doubles.
  double half_width() const { return std::max(0.5 * high[0] - 0.5 * low[0], 0.5 * high[1] - 0.5 * low[1]); }
  bool is_point() const { return low[0] == high[0] && low[1] == high[1]; }
  std::uint32_t place(const Vec2& point, double half_width) const {
    return place_on_curve(square_of(point[0], low[0], half_width), square_of(point[1], low[1], half_width));
  }
};

constexpr std::size_t k_block = std::size_t{1} << 16;  ///< points: takes a moment

/// Calls work(share, begin, end) for each share of `count` things, block by block; tells the job from time to time.
template <class Work>
void for_shares(std::size_t count, Index shares, const JobStage& stage, Work&& work) {
  parallel_for(shares, shares, 1, [&](Index share, int) {
    const std::size_t first = count * share / shares, last = count * (share + 1) / shares;
    for (std::size_t begin = first; begin < last; begin += k_block) {
      stage.update(static_cast<double>(begin - first) / static_cast<double>(last - first));
      work(share, begin, std::min(last, begin + k_block));
    }
  });
}

/// Sorts by some bits of their places, from the lowest one on: stable.
void sort_by_digit(std::span<const Placed> items, std::span<Placed> sorted, int lowest, int bits, Index shares,
                   const JobStage& stage) {
  const std::uint32_t values = 1u << bits;
  const auto digit = [=](const Placed& item) { return (item.place >> lowest) & (values - 1); };
  std::vector<Index> next(static_cast<std::size_t>(shares) * values, 0);  // by share, digit: where its next item goes
  for_shares(items.size(), shares, stage.part(0, 0.3), [&](Index share, std::size_t begin, std::size_t end) {
    Index* const count = next.data() + static_cast<std::size_t>(share) * values;
    const Placed* const from = items.data();
    for (std::size_t i = begin; i < end; ++i) ++count[digit(from[i])];
  });
  Index before = 0;
  for (std::uint32_t value = 0; value < values; ++value)
    for (std::size_t at = value; at < next.size(); at += values) before += std::exchange(next[at], before);
  for_shares(items.size(), shares, stage.part(0.3, 1), [&](Index share, std::size_t begin, std::size_t end) {
    Index* const at = next.data() + static_cast<std::size_t>(share) * values;
    const Placed* const from = items.data();
    Placed* const to = sorted.data();
    for (std::size_t i = begin; i < end; ++i) to[at[digit(from[i])]++] = from[i];
  });
}

/// Bits of a digit of which two part most of so many points that lie evenly.
int digit_for(std::size_t count) {
  constexpr std::size_t k_many = std::size_t{1} << 22, k_few = std::size_t{1} << 14;
  return count >= k_many ? 12 : count >= k_few ? 11 : 8;
}

/// Puts points in order that share a square of the curve, or a larger one. Items that nothing else tells apart are by
/// index, before and after. What takes long tells its stage; the rest is only stopped there.
class RunSorter {
 public:
  explicit RunSorter(std::span<const Vec2> points) : points_(points) {}

  /// Items are in order but for the last `open_bits` of their places.
  void sort_open(std::span<Placed> items, int open_bits, const JobStage& stage) const {
    for (std::size_t begin = 0, end; begin < items.size(); begin = end) {
      const std::uint32_t square = items[begin].place >> open_bits;
      for (end = begin + 1; end < items.size() && items[end].place >> open_bits == square;) ++end;
      if (end - begin == 1) continue;
      stage.check();
      const std::span<Placed> run = items.subspan(begin, end - begin);
      if (run.size() <= k_many) {
        sort_by_place(run);
        sort_runs(run, stage);
      } else {
        const JobStage part = part_of(stage, begin, end, items.size());
        sort_by_digits(run, 0, open_bits / 2, open_bits - open_bits / 2, part.part(0, 0.2));
        sort_runs(run, part.part(0.2, 1));
      }
    }
  }

 private:
  static constexpr std::size_t k_many = k_block;

  static JobStage part_of(const JobStage& stage, std::size_t begin, std::size_t end, std::size_t size) {
    return stage.part(static_cast<double>(begin) / static_cast<double>(size),
                      static_cast<double>(end) / static_cast<double>(size));
  }

  /// Sorts by two digits of the places: bits from `lowest` on, then those above.
  static void sort_by_digits(std::span<Placed> items, int lowest, int bits, int bits_above, const JobStage& stage) {
    LargeArray<Placed> other(items.size());
    sort_by_digit(items, other, lowest, bits, 1, stage.part(0, 0.5));
    sort_by_digit(other, items, lowest + bits, bits_above, 1, stage.part(0.5, 1));
  }

  /// Sorts items by place, those of one place by index, in which they come.
  static void sort_by_place(std::span<Placed> items) {
    constexpr std::size_t k_few = 16;
    if (items.size() > k_few) {
      if (!std::is_sorted(items.begin(), items.end(), is_before)) std::sort(items.begin(), items.end(), is_before);
      return;
    }
    for (std::size_t i = 1; i < items.size(); ++i) {
      const Placed item = items[i];
      std::size_t to = i;
      for (; to > 0 && item.place < items[to - 1].place; --to) items[to] = items[to - 1];
      items[to] = item;
    }
  }
  static bool is_before(const Placed& a, const Placed& b) {
    return a.place != b.place ? a.place < b.place : a.index < b.index;
  }

  void sort_runs(std::span<Placed> items, const JobStage& stage) const {
    for (std::size_t begin = 0, end; begin < items.size(); begin = end) {
      for (end = begin + 1; end < items.size() && items[end].place == items[begin].place;) ++end;
      if (end - begin == 1) continue;
      stage.check();
      const std::span<Placed> run = items.subspan(begin, end - begin);
      sort(run, run.size() <= k_many ? stage : part_of(stage, begin, end, items.size()));
    }
  }

  /// Sorts by a curve over the points' own box; equal points end up side by side, the smallest index first.
  void sort(std::span<Placed> items, const JobStage& stage) const {
    const std::uint32_t outer_place = items[0].place;
    sort_inside(items, stage);
    for (Placed& item : items) item.place = outer_place;
  }

  void sort_inside(std::span<Placed> items, const JobStage& stage) const {
    if (items.size() <= k_curve_run) return sort_by_point(items);
    if (items.size() <= k_many) {
      if (!place(items, {})) return;
      std::sort(items.begin(), items.end(), is_before);
      return sort_runs(items, stage);
    }
    if (!place(items, stage.part(0, 0.3))) return;
    const int digit = digit_for(items.size()), open_bits = 2 * (k_bits - digit);
    sort_by_digits(items, open_bits, digit, digit, stage.part(0.3, 0.6));
    sort_open(items, open_bits, stage.part(0.6, 1));
  }

  /// Fills in the places; false when that does not part the points, which then are in order.
  bool place(std::span<Placed> items, const JobStage& stage) const {
    Box box;
    for_shares(items.size(), 1, stage.part(0, 0.5), [&](Index, std::size_t begin, std::size_t end) {
      for (const Placed& item : items.subspan(begin, end - begin)) box.add(points_[item.index]);
    });
    const double half_width = box.half_width();
    if (!(half_width > 0)) {  // some may still differ, by the smallest doubles
      if (!box.is_point()) sort_by_point(items);
      return false;
    }
    for_shares(items.size(), 1, stage.part(0.5, 1), [&](Index, std::size_t begin, std::size_t end) {
      for (Placed& item : items.subspan(begin, end - begin)) item.place = box.place(points_[item.index], half_width);
    });
    return true;
  }

  void sort_by_point(std::span<Placed> items) const {
    std::sort(items.begin(), items.end(), [&](const Placed& a, const Placed& b) { return less(a.index, b.index); });
  }
  bool less(Index a, Index b) const {
    const Vec2 &p = points_[a], &q = points_[b];
    if (p.x() != q.x()) return p.x() < q.x();
    return p.y() != q.y() ? p.y() < q.y() : a < b;
  }
  std::span<const Vec2> points_;
};

/// All points at once, by any number of threads: each has a share of them, the same in all steps.
class Sorter {
 public:
  Sorter(std::span<const Vec2> points, int threads, const JobStage& stage)
      : points_(points),
        stage_(stage),
        shares_(std::clamp(static_cast<Index>(points.size() / k_worth_a_thread), 1, thread_count(threads))),
        items_(points.size()) {}

  LargeArray<Placed> sorted() {
    const int digit = digit_for(items_.size()), open_bits = 2 * (k_bits - digit);
    if (place()) {
      LargeArray<Placed> other(items_.size());
      sort_by_digit(items_, other, open_bits, digit, shares_, stage_.part(0.3, 0.6));
      sort_by_digit(other, items_, open_bits + digit, digit, shares_, stage_.part(0.6, 0.9));
    }
    sort_runs(open_bits);
    return std::move(items_);
  }

 private:
  static constexpr std::size_t k_worth_a_thread = std::size_t{1} << 14;

  /// Fills in the places; false when all points are one.
  bool place() {
    std::vector<Box> boxes(shares_);
    for_shares(points_.size(), shares_, stage_.part(0, 0.1), [&](Index share, std::size_t begin, std::size_t end) {
      Box box = boxes[share];
      for (std::size_t i = begin; i < end; ++i) box.add(points_[i]);
      boxes[share] = box;
    });
    Box all;
    for (const Box& box : boxes) all.add(box);
    const double half_width = all.half_width();
    const bool has_places = half_width > 0;
    for_shares(points_.size(), shares_, stage_.part(0.1, 0.3), [&](Index, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        items_[i] = {has_places ? all.place(points_[i], half_width) : 0, static_cast<Index>(i)};
    });
    return has_places;
  }

  void sort_runs(int open_bits) {
    const JobStage stage = stage_.part(0.9, 1);
    const std::size_t count = items_.size(), pieces = (count + k_block - 1) / k_block;
    std::vector<std::size_t> begin(pieces + 1, count);  // where no run is under way
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      std::size_t at = std::max(piece * k_block, piece == 0 ? 0 : begin[piece - 1]);
      while (0 < at && at < count && items_[at].place >> open_bits == items_[at - 1].place >> open_bits) ++at;
      begin[piece] = at;
    }
    const RunSorter runs(points_);
    parallel_for(static_cast<Index>(pieces), shares_, 1, [&](Index piece, int) {
      const auto share = [&](std::size_t at) { return static_cast<double>(at) / static_cast<double>(count); };
      const JobStage part = stage.part(share(begin[piece]), share(begin[piece + 1]));
      part.update(0);
      runs.sort_open(std::span(items_).subspan(begin[piece], begin[piece + 1] - begin[piece]), open_bits, part);
    });
  }

  std::span<const Vec2> points_;
  const JobStage& stage_;
  Index shares_;
  LargeArray<Placed> items_;
};

}  // namespace

LargeArray<Placed> curve_order(std::span<const Vec2> points, int threads, const JobStage& stage) {
  LargeArray<Placed> items = Sorter(points, threads, stage).sorted();
  stage.update(1);
  return items;
}

LargeArray<std::uint32_t> places_in_square(std::span<const double> x, std::span<const double> y,
                                           const JobStage& stage) {
  Box box;
  for_shares(x.size(), 1, stage.part(0, 0.5), [&](Index, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) box.add(Vec2(x[i], y[i]));
  });
  const double half_width = box.half_width();
  if (x.size() <= k_curve_run || !(half_width > 0)) return {};
  LargeArray<std::uint32_t> places(x.size());
  bool is_sorted = true;
  for_shares(x.size(), 1, stage.part(0.5, 1), [&](Index, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      places[i] = box.place(Vec2(x[i], y[i]), half_width);
      is_sorted &= i == 0 || places[i - 1] <= places[i];
    }
  });
  if (!is_sorted) places.clear();
  return places;
}

}  // namespace saddleback::voronoi2d
