// Places along a Hilbert curve of 2^16 x 2^16 squares over the points' box, sorted by radix; points that share a square
// are put in order by a curve over their own box, and so on, which follows clusters of any size.

#include "voronoi2d/curve_order.h"

#include <algorithm>
#include <array>
#include <limits>

#include "voronoi2d/curve_place.h"

namespace saddleback::voronoi2d {
namespace {

constexpr int k_bits = k_curve_bits;

// Hilbert's curve, two bits of each axis at a time: state, then bits of x and y, to bits of the place and a new state.
struct CurveTable {
  struct Step {
    std::uint8_t place, state;
  };
  std::array<Step, 4 * 16> steps{};

  constexpr CurveTable() {
    for (unsigned state = 0; state < 4; ++state) {
      for (unsigned xy = 0; xy < 16; ++xy) {
        std::uint32_t s = state, place = 0;
        for (int bit = 1; bit >= 0; --bit) place = 4 * place + curve_step((xy >> (2 + bit)) & 1, (xy >> bit) & 1, s);
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

// Calls work(item) for all; tells the job from time to time.
template <class Items, class Work>
void for_blocks(Items& items, const JobStage& stage, Work&& work) {
  constexpr std::size_t k_block = std::size_t{1} << 16;
  for (std::size_t begin = 0; begin < items.size(); begin += k_block) {
    stage.update(static_cast<double>(begin) / static_cast<double>(items.size()));
    const std::size_t end = std::min(items.size(), begin + k_block);
    for (std::size_t i = begin; i < end; ++i) work(items[i]);
  }
}

// Stable, least digit first.
void radix_sort(LargeArray<Placed>& items, LargeArray<Placed>& other, const JobStage& stage) {
  constexpr int k_digit = 11;
  constexpr std::size_t k_values = std::size_t{1} << k_digit;
  other.resize(items.size());
  for (int shift = 0; shift < 2 * k_bits; shift += k_digit) {
    std::array<std::size_t, k_values + 1> begin{};
    const JobStage pass = stage.part(shift / (2.0 * k_bits), std::min(1.0, (shift + k_digit) / (2.0 * k_bits)));
    for_blocks(items, pass.part(0, 0.3),
               [&](const Placed& item) { ++begin[((item.place >> shift) & (k_values - 1)) + 1]; });
    for (std::size_t i = 0; i < k_values; ++i) begin[i + 1] += begin[i];
    for_blocks(items, pass.part(0.3, 1),
               [&](const Placed& item) { other[begin[(item.place >> shift) & (k_values - 1)]++] = item; });
    items.swap(other);
  }
}

struct Box {
  double low[2] = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  double high[2] = {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
};

class Sorter {
 public:
  Sorter(std::span<const Vec2> points, const JobStage& stage) : points_(points), stage_(stage) {}

  /// Sorts indices along the curve over their box; equal points end up side by side, the smallest index first.
  void sort(std::span<Placed> items) {
    const std::uint32_t outer_place = items[0].place;
    sort_inside(items);
    for (Placed& item : items) item.place = outer_place;
  }

  void sort_inside(std::span<Placed> items) {
    constexpr std::size_t k_few = 48;
    if (items.size() <= k_few || !place(items, stage_.part(0, 0))) {
      std::sort(items.begin(), items.end(), [&](const Placed& a, const Placed& b) { return less(a.index, b.index); });
      return;
    }
    std::sort(items.begin(), items.end(), [](const Placed& a, const Placed& b) {
      return a.place != b.place ? a.place < b.place : a.index < b.index;
    });
    sort_runs(items);
  }

  void sort_runs(std::span<Placed> items) {
    for (std::size_t begin = 0, end; begin < items.size(); begin = end) {
      for (end = begin + 1; end < items.size() && items[end].place == items[begin].place;) ++end;
      if (end - begin == 1) continue;
      stage_.check();
      sort(items.subspan(begin, end - begin));
    }
  }

  /// Fills in the places; false when all points are one.
  bool place(std::span<Placed> items, const JobStage& stage) {
    Box box;
    for_blocks(items, stage.part(0, 0.3), [&](const Placed& item) {
      for (int k = 0; k < 2; ++k) {
        box.low[k] = std::min(box.low[k], points_[item.index][k]);
        box.high[k] = std::max(box.high[k], points_[item.index][k]);
      }
    });
    // Halves, since the width of the box may be beyond the doubles.
    const double width = std::max(0.5 * box.high[0] - 0.5 * box.low[0], 0.5 * box.high[1] - 0.5 * box.low[1]);
    if (!(width > 0)) return false;
    for_blocks(items, stage.part(0.3, 1), [&](Placed& item) {
      std::uint32_t square[2];
      for (int k = 0; k < 2; ++k) square[k] = square_of(points_[item.index][k], box.low[k], width);
      item.place = place_on_curve(square[0], square[1]);
    });
    return true;
  }

 private:
  bool less(Index a, Index b) const {
    const Vec2 &p = points_[a], &q = points_[b];
    if (p.x() != q.x()) return p.x() < q.x();
    return p.y() != q.y() ? p.y() < q.y() : a < b;
  }
  std::span<const Vec2> points_;
  const JobStage& stage_;
};

}  // namespace

LargeArray<Placed> curve_order(std::span<const Vec2> points, const JobStage& stage) {
  LargeArray<Placed> items(points.size()), other;
  Index next = 0;
  for_blocks(items, stage.part(0, 0.1), [&](Placed& item) { item = {0, next++}; });
  const JobStage last = stage.part(0.9, 1);
  Sorter sorter(points, last);
  if (items.size() > 1 && sorter.place(items, stage.part(0.1, 0.3))) radix_sort(items, other, stage.part(0.3, 0.9));
  sorter.sort_runs(items);
  stage.update(1);
  return items;
}

}  // namespace saddleback::voronoi2d
