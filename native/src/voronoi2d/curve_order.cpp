// Places along a Hilbert curve of 2^16 x 2^16 squares over the points' box, sorted by radix, as many digits as part
// most points, then those that are left side by side; points that share a square are put in order by a curve over their
// own box, and so on, which follows clusters of any size.

#include "voronoi2d/curve_order.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "support/parallel.h"
#include "voronoi2d/curve_place.h"

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

std::uint32_t place_on_curve(std::uint32_t x, std::uint32_t y) {
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
  std::uint32_t place(const Vec2& point, double half_width) const {
    return place_on_curve(square_of(point[0], low[0], half_width), square_of(point[1], low[1], half_width));
  }
};

/// Puts points in order that share a square of the curve, or a larger one.
class RunSorter {
 public:
  RunSorter(std::span<const Vec2> points, const JobStage& stage) : points_(points), stage_(stage) {}

  /// Items are in order but for the last `open_bits` of their places, and by index where all others are equal.
  void sort_open(std::span<Placed> items, int open_bits) const {
    for (std::size_t begin = 0, end; begin < items.size(); begin = end) {
      const std::uint32_t square = items[begin].place >> open_bits;
      for (end = begin + 1; end < items.size() && items[end].place >> open_bits == square;) ++end;
      if (end - begin == 1) continue;
      stage_.check();
      const std::span<Placed> run = items.subspan(begin, end - begin);
      sort_by_place(run);
      sort_runs(run);
    }
  }

 private:
  /// Stable: items are by index.
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

  void sort_runs(std::span<Placed> items) const {
    for (std::size_t begin = 0, end; begin < items.size(); begin = end) {
      for (end = begin + 1; end < items.size() && items[end].place == items[begin].place;) ++end;
      if (end - begin == 1) continue;
      stage_.check();
      sort(items.subspan(begin, end - begin));
    }
  }

  /// By a curve over the points' own box; equal points end up side by side, the smallest index first.
  void sort(std::span<Placed> items) const {
    const std::uint32_t outer_place = items[0].place;
    sort_inside(items);
    for (Placed& item : items) item.place = outer_place;
  }

  void sort_inside(std::span<Placed> items) const {
    constexpr std::size_t k_few = 48;
    if (items.size() <= k_few || !place(items)) {
      std::sort(items.begin(), items.end(), [&](const Placed& a, const Placed& b) { return less(a.index, b.index); });
      return;
    }
    std::sort(items.begin(), items.end(), is_before);
    sort_runs(items);
  }

  /// Fills in the places; false when all points are one.
  bool place(std::span<Placed> items) const {
    Box box;
    for (const Placed& item : items) box.add(points_[item.index]);
    const double half_width = box.half_width();
    if (!(half_width > 0)) return false;
    for (Placed& item : items) item.place = box.place(points_[item.index], half_width);
    return true;
  }

  bool less(Index a, Index b) const {
    const Vec2 &p = points_[a], &q = points_[b];
    if (p.x() != q.x()) return p.x() < q.x();
    return p.y() != q.y() ? p.y() < q.y() : a < b;
  }
  std::span<const Vec2> points_;
  const JobStage& stage_;
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
    const int digit = digit_for(items_.size());
    if (place()) sort_by_place(digit);
    sort_runs(2 * (k_bits - digit));
    return std::move(items_);
  }

 private:
  static constexpr std::size_t k_block = std::size_t{1} << 16, k_worth_a_thread = std::size_t{1} << 14;

  /// Calls work(share, begin, end) for each share of the points, piece by piece; tells the job from time to time.
  template <class Work>
  void for_shares(const JobStage& stage, Work&& work) {
    const std::size_t count = points_.size();
    parallel_for(shares_, shares_, 1, [&](Index share, int) {
      const std::size_t first = count * share / shares_, last = count * (share + 1) / shares_;
      for (std::size_t begin = first; begin < last; begin += k_block) {
        stage.update(static_cast<double>(begin - first) / static_cast<double>(last - first));
        work(share, begin, std::min(last, begin + k_block));
      }
    });
  }

  /// Fills in the places; false when all points are one.
  bool place() {
    std::vector<Box> boxes(shares_);
    for_shares(stage_.part(0, 0.1), [&](Index share, std::size_t begin, std::size_t end) {
      Box box = boxes[share];
      for (std::size_t i = begin; i < end; ++i) box.add(points_[i]);
      boxes[share] = box;
    });
    Box all;
    for (const Box& box : boxes) all.add(box);
    const double half_width = all.half_width();
    const bool has_places = half_width > 0;
    for_shares(stage_.part(0.1, 0.3), [&](Index, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        items_[i] = {has_places ? all.place(points_[i], half_width) : 0, static_cast<Index>(i)};
    });
    return has_places;
  }

  /// Bits of a digit of which two part most of so many points that lie evenly.
  static int digit_for(std::size_t count) {
    constexpr std::size_t k_many = std::size_t{1} << 22, k_few = std::size_t{1} << 14;
    return count >= k_many ? 12 : count >= k_few ? 11 : 8;
  }

  /// By the two highest digits: by radix, stable, the lower one first.
  void sort_by_place(int digit_bits) {
    const std::uint32_t values = 1u << digit_bits;
    LargeArray<Placed> other(items_.size());
    std::vector<Index> next(static_cast<std::size_t>(shares_) * values);  // by share, digit: where its next item goes
    for (int pass_number = 0; pass_number < 2; ++pass_number) {
      const int shift = 2 * k_bits - (2 - pass_number) * digit_bits;
      const auto digit = [=](const Placed& item) { return (item.place >> shift) & (values - 1); };
      const JobStage pass = stage_.part(0.3 + 0.3 * pass_number, 0.6 + 0.3 * pass_number);
      std::fill(next.begin(), next.end(), 0);
      for_shares(pass.part(0, 0.3), [&](Index share, std::size_t begin, std::size_t end) {
        Index* const count = next.data() + static_cast<std::size_t>(share) * values;
        const Placed* const items = items_.data();
        for (std::size_t i = begin; i < end; ++i) ++count[digit(items[i])];
      });
      Index before = 0;
      for (std::uint32_t value = 0; value < values; ++value)
        for (std::size_t at = value; at < next.size(); at += values) before += std::exchange(next[at], before);
      for_shares(pass.part(0.3, 1), [&](Index share, std::size_t begin, std::size_t end) {
        Index* const to = next.data() + static_cast<std::size_t>(share) * values;
        const Placed* const items = items_.data();
        Placed* const sorted = other.data();
        for (std::size_t i = begin; i < end; ++i) sorted[to[digit(items[i])]++] = items[i];
      });
      items_.swap(other);
    }
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
    const RunSorter runs(points_, stage);
    parallel_for(static_cast<Index>(pieces), shares_, 1, [&](Index piece, int) {
      stage.update(piece / static_cast<double>(pieces));
      runs.sort_open(std::span(items_).subspan(begin[piece], begin[piece + 1] - begin[piece]), open_bits);
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

}  // namespace saddleback::voronoi2d
