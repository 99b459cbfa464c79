#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "saddleback/types.h"

namespace saddleback {

/// Sets of numbers that grow together: a union-find forest with halved paths. The root of a set is its smallest number.
class DisjointSets {
 public:
  explicit DisjointSets(Index count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  Index root(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  /// Tells whether they were in two sets.
  bool join(Index a, Index b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
    return a != b;
  }

 private:
  std::vector<Index> parent_;
};

}  // namespace saddleback
