#include "support/sparse_cholesky.h"

#include <algorithm>
#include <numeric>

namespace saddleback {
namespace {

constexpr Index k_small = 32;  // so few unknowns are not worth cutting in half

/// Unknowns [begin, end) of the list that go to the rows before `row_end`.
struct Part {
  Index begin, end, row_end;
};

int longest_axis(std::span<const Index> unknowns, std::span<const Vec3> places) {
  Vec3 low = places[unknowns[0]], high = low;
  for (const Index i : unknowns) {
    low = low.cwiseMin(places[i]);
    high = high.cwiseMax(places[i]);
  }
  Eigen::Index axis;
  (high - low).maxCoeff(&axis);
  return static_cast<int>(axis);
}

}  // namespace

std::vector<Index> dissection_order(const SymmetricMatrix& matrix, std::span<const Vec3> places) {
  const Index size = matrix.size();
  std::vector<Index> order(size), list(size);
  std::iota(list.begin(), list.end(), 0);
  std::vector<std::uint8_t> is_beyond(size, 0);
  std::vector<Part> parts{{0, size, size}};
  while (!parts.empty()) {
    const auto [begin, end, row_end] = parts.back();
    parts.pop_back();
    const Index count = end - begin;
    if (count <= k_small) {
      std::copy(list.begin() + begin, list.begin() + end, order.begin() + (row_end - count));
      continue;
    }
    const int axis = longest_axis(std::span(list).subspan(begin, count), places);
    const Index middle = begin + count / 2;
    std::nth_element(list.begin() + begin, list.begin() + middle, list.begin() + end, [&](Index a, Index b) {
      return places[a][axis] < places[b][axis] || (places[a][axis] == places[b][axis] && a < b);
    });
    for (Index i = middle; i < end; ++i) is_beyond[list[i]] = 1;
    const auto is_inner = [&](Index unknown) {
      const std::span<const Index> row = matrix.row(unknown);
      return std::none_of(row.begin(), row.end(), [&](Index other) { return is_beyond[other] != 0; });
    };
    const auto separator =
        static_cast<Index>(std::partition(list.begin() + begin, list.begin() + middle, is_inner) - list.begin());
    for (Index i = middle; i < end; ++i) is_beyond[list[i]] = 0;
    const Index between = middle - separator;
    std::copy(list.begin() + separator, list.begin() + middle, order.begin() + (row_end - between));
    parts.push_back({begin, separator, row_end - between - (end - middle)});
    parts.push_back({middle, end, row_end - between});
  }
  return order;
}

SparseCholesky::SparseCholesky(const SymmetricMatrix& matrix, std::vector<Index> order, const JobStage& stage)
    : order_(std::move(order)), place_(matrix.size()), parent_(matrix.size(), k_none), pivots_(matrix.size()) {
  const Index size = matrix.size();
  for (Index row = 0; row < size; ++row) place_[order_[row]] = row;
  count_entries(matrix);
  rows_.resize(offsets_.back());
  values_.resize(offsets_.back());
  ends_.assign(offsets_.begin(), offsets_.end() - 1);
  work_.assign(size, 0);
  pattern_.resize(size);
  flags_.assign(size, k_none);
  std::int64_t done = 0, looked = 0, all = 1;  // multiplications
  for (Index column = 0; column < size; ++column) {
    const std::int64_t count = offsets_[column + 1] - offsets_[column];
    all += count * (count - 1) / 2;
  }
  constexpr std::int64_t k_look = 1 << 20;  // between looks at the job: about a millisecond
  for (Index row = 0; row < size; ++row) {
    done += eliminate(matrix, row);
    if (done - looked < k_look) continue;
    looked = done;
    stage.update(static_cast<double>(done) / static_cast<double>(all));
  }
  stage.update(1);
}

/// Puts the row's entries left of the diagonal into work_; returns where its columns begin in pattern_, which ends with
/// the last of them, in an order in which they may be eliminated.
Index SparseCholesky::spread(const SymmetricMatrix& matrix, Index row) {
  const Index unknown = order_[row];
  Index first = matrix.size();
  flags_[row] = row;
  for (Index e = matrix.offsets[unknown]; e < matrix.offsets[unknown + 1]; ++e) {
    Index column = place_[matrix.columns[e]];
    if (column >= row) continue;
    work_[column] += matrix.values[e];
    path_.clear();
    for (; flags_[column] != row; column = parent_[column]) {
      path_.push_back(column);
      flags_[column] = row;
    }
    first -= static_cast<Index>(path_.size());
    std::copy(path_.begin(), path_.end(), pattern_.begin() + first);
  }
  return first;
}

/// Finds a row of L and its pivot; returns the number of multiplications.
std::int64_t SparseCholesky::eliminate(const SymmetricMatrix& matrix, Index row) {
  double pivot = matrix.diagonal[order_[row]];
  std::int64_t done = 0;
  for (Index i = spread(matrix, row); i < matrix.size(); ++i) {
    const Index column = pattern_[i];
    const double value = work_[column];
    work_[column] = 0;
    for (std::int64_t e = offsets_[column]; e < ends_[column]; ++e) work_[rows_[e]] -= values_[e] * value;
    done += ends_[column] - offsets_[column];
    const double factor = value / pivots_[column];
    pivot -= factor * value;
    rows_[ends_[column]] = row;
    values_[ends_[column]++] = factor;
  }
  pivots_[row] = pivot;
  return done;
}

/// The elimination tree, and where the columns of L begin.
void SparseCholesky::count_entries(const SymmetricMatrix& matrix) {
  const Index size = matrix.size();
  std::vector<Index> flags(size, k_none);
  std::vector<std::int64_t> counts(size, 0);
  for (Index row = 0; row < size; ++row) {
    flags[row] = row;
    for (const Index other : matrix.row(order_[row])) {
      for (Index column = place_[other]; column < row && flags[column] != row; column = parent_[column]) {
        if (parent_[column] == k_none) parent_[column] = row;
        ++counts[column];
        flags[column] = row;
      }
    }
  }
  offsets_.assign(1, 0);
  for (const std::int64_t count : counts) offsets_.push_back(offsets_.back() + count);
}

std::vector<Vec2> SparseCholesky::solve(std::span<const Vec2> right) const {
  const auto size = static_cast<Index>(right.size());
  std::vector<Vec2> work(size), result(size);
  for (Index row = 0; row < size; ++row) work[row] = right[order_[row]];
  for (Index column = 0; column < size; ++column)
    for (std::int64_t e = offsets_[column]; e < offsets_[column + 1]; ++e) work[rows_[e]] -= values_[e] * work[column];
  for (Index column = size - 1; column >= 0; --column) {
    work[column] /= pivots_[column];
    for (std::int64_t e = offsets_[column]; e < offsets_[column + 1]; ++e) work[column] -= values_[e] * work[rows_[e]];
  }
  for (Index row = 0; row < size; ++row) result[order_[row]] = work[row];
  return result;
}

}  // namespace saddleback
