// Places along a Hilbert curve of 2^16 x 2^16 squares over the points' box; points that share a square are put in order
// by a curve over their own box, and so on, which follows clusters of any size.

#include "voronoi2d/sites/curve_order.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "support/key_order.h"
#include "support/threads/parallel.h"
#include "voronoi2d/sites/curve_place.h"

namespace saddleback::voronoi2d {
namespace {

static_assert([] {
  for (std::uint32_t i = 1, square = 1; i <= 1000; ++i) {
    square = square * 1664525u + 1013904223u;  // any
    const std::uint32_t x = square >> k_curve_bits, y = (square ^ i * 40503u) & 0xffffu;
    std::uint32_t state = 0, place = 0;
    for (int bit = k_curve_bits - 1; bit >= 0; --bit) place = 4 * place + curve_step(x >> bit & 1, y >> bit & 1, state);
    if (place != place_of_square(x, y)) return false;
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
  std::uint32_t place(const Vec2& point, double half_width) const {
    return place_of_square(square_of(point[0], low[0], half_width), square_of(point[1], low[1], half_width));
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

/// Puts points, which come by ascending index, in the order of a curve over their box, and those that share a square of
/// it in the order of one over their own, and so on; equal points end up side by side, the smallest index first.
class Sorter {
 public:
  explicit Sorter(std::span<const Vec2> points) : points_(points) {}

  void sort(std::span<Placed> items, int threads, const JobStage& stage) const {
    constexpr std::size_t k_worth_a_thread = std::size_t{1} << 14;
    const Index shares = std::clamp(static_cast<Index>(items.size() / k_worth_a_thread), 1, thread_count(threads));
    if (!place(items, shares, stage.part(0, 0.3))) return sort_by_point(items);
    sort_by_key(items, shares, stage.part(0.3, 0.9));
    const std::size_t count = items.size();
    const JobStage runs = stage.part(0.9, 1);
    const auto share_of = [&](std::size_t at) { return static_cast<double>(at) / static_cast<double>(count); };
    parallel_for(static_cast<Index>((count + k_block - 1) / k_block), shares, 1, [&](Index i, int) {
      std::size_t begin = i * k_block;
      const std::size_t last = std::min(count, begin + k_block);
      runs.update(share_of(begin));
      while (0 < begin && begin < last && items[begin].key == items[begin - 1].key) ++begin;
      for (std::size_t end; begin < last; begin = end) {
        for (end = begin + 1; end < count && items[end].key == items[begin].key;) ++end;
        if (end - begin > 1) sort_run(items.subspan(begin, end - begin), runs.part(share_of(begin), share_of(end)));
      }
    });
  }

 private:
  /// Fills in the places; false when all would be one.
  bool place(std::span<Placed> items, Index shares, const JobStage& stage) const {
    std::vector<Box> boxes(shares);
    for_shares(items.size(), shares, stage.part(0, 0.4), [&](Index share, std::size_t begin, std::size_t end) {
      Box box = boxes[share];
      for (const Placed& item : items.subspan(begin, end - begin)) box.add(points_[item.index]);
      boxes[share] = box;
    });
    Box all;
    for (const Box& box : boxes) all.add(box);
    const double half_width = all.half_width();
    if (!(half_width > 0)) return false;
    for_shares(items.size(), shares, stage.part(0.4, 1), [&](Index, std::size_t begin, std::size_t end) {
      for (Placed& item : items.subspan(begin, end - begin)) item.key = all.place(points_[item.index], half_width);
    });
    return true;
  }

  /// Sorts what shares a square, whose place stays: others look at it meanwhile.
  void sort_run(std::span<Placed> run, const JobStage& stage) const {
    stage.check();
    std::vector<Placed> own(run.begin(), run.end());
    if (own.size() <= k_curve_run)
      sort_by_point(own);
    else
      sort(own, 1, stage);
    for (std::size_t i = 0; i < run.size(); ++i) run[i].index = own[i].index;
  }

  void sort_by_point(std::span<Placed> items) const {
    const auto is_before = [&](const Placed& a, const Placed& b) {
      const Vec2 &p = points_[a.index], &q = points_[b.index];
      if (p.x() != q.x()) return p.x() < q.x();
      return p.y() != q.y() ? p.y() < q.y() : a.index < b.index;
    };
    if (!std::is_sorted(items.begin(), items.end(), is_before)) std::sort(items.begin(), items.end(), is_before);
  }

  std::span<const Vec2> points_;
};

}  // namespace

LargeArray<Placed> curve_order(std::span<const Vec2> points, int threads, const JobStage& stage) {
  LargeArray<Placed> items(points.size());
  parallel_for(static_cast<Index>(points.size()), threads, static_cast<Index>(k_block), [&](Index i, int) {
    items[i] = {0, i};
  });
  Sorter(points).sort(items, threads, stage);
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
