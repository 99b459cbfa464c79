#include "field/linear/color_order.h"

#include <algorithm>
#include <utility>

#include "field/linear/row_blocks.h"

namespace saddleback {
namespace {

/// Finds the first color that no neighbor from `begin` to `end` has.
template <class Scalar>
Index free_color(const GraphMatrix<Scalar>& matrix, Index i, Index begin, Index end, const std::vector<Index>& color,
                 std::vector<Index>& taken_by) {
  for (Index k = matrix.begins[i]; k < matrix.begins[i + 1]; ++k) {
    const Index j = matrix.columns[k];
    if (j < begin || j >= end || color[j] == k_none) continue;
    if (static_cast<std::size_t>(color[j]) >= taken_by.size()) taken_by.resize(color[j] + 1, k_none);
    taken_by[color[j]] = i;
  }
  return static_cast<Index>(std::ranges::find_if(taken_by, [&](Index node) { return node != i; }) - taken_by.begin());
}

/// Gives each node the first color that no neighbor of its stretch has, then another where one of a stretch before has
/// it too.
template <class Scalar>
std::vector<Index> colors_of(const GraphMatrix<Scalar>& matrix, const JobStage& stage) {
  const Index size = matrix.size();
  std::vector<Index> color(size, k_none);
  std::vector<std::vector<Index>> again((size + k_stretch - 1) / k_stretch);
  for_stretches(size, stage, [&](Index begin, Index end) {
    std::vector<Index> taken_by;
    for (Index i = begin; i < end; ++i) color[i] = free_color(matrix, i, begin, end, color, taken_by);
  });
  for_stretches(size, stage, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const auto has_it = [&](Index j) { return j < begin && color[j] == color[i]; };
      const auto row = matrix.columns.begin();
      if (std::any_of(row + matrix.begins[i], row + matrix.begins[i + 1], has_it))
        again[begin / k_stretch].push_back(i);
    }
  });
  std::vector<Index> taken_by;
  for (const std::vector<Index>& nodes : again) {
    stage.check();
    for (const Index i : nodes) color[i] = free_color(matrix, i, 0, size, color, taken_by);
  }
  return color;
}

}  // namespace

template <class Scalar>
ColorOrder order_by_color(const GraphMatrix<Scalar>& matrix, const JobStage& stage) {
  const Index size = matrix.size(), stretches = (size + k_stretch - 1) / k_stretch;
  const std::vector<Index> color = colors_of(matrix, stage);
  const Index count = size == 0 ? 1 : *std::ranges::max_element(color) + 1;
  std::vector<Index> next(static_cast<std::size_t>(stretches) * count, 0);  // of each stretch, for each color
  for_stretches(size, stage, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) ++next[begin / k_stretch * count + color[i]];
  });
  ColorOrder result{{}, UnsetArray<Index>(size), UnsetArray<Index>(size)};
  Index total = 0;
  for (Index c = 0; c < count; ++c) {
    result.begins.push_back(total);
    for (Index s = 0; s < stretches; ++s) total += std::exchange(next[s * count + c], total);
  }
  result.begins.push_back(total);
  for_stretches(size, stage, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      result.place[i] = next[begin / k_stretch * count + color[i]]++;
      result.order[result.place[i]] = i;
    }
  });
  return result;
}

template ColorOrder order_by_color(const GraphMatrix<double>&, const JobStage&);
template ColorOrder order_by_color(const GraphMatrix<std::complex<double>>&, const JobStage&);

}  // namespace saddleback
