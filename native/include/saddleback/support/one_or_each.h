#pragma once
// Options that are given once for all, or once for each.

#include <vector>

#include "saddleback/types.h"

namespace saddleback {

/// Returns what is given for the i-th: of a list of one it is that one.
template <class T>
const T& one_or_each(const std::vector<T>& values, Index i) {
  return values.size() == 1 ? values[0] : values[static_cast<std::size_t>(i)];
}

}  // namespace saddleback
