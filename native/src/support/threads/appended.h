#pragma once
// What threads find, in the order of where they looked.

#include <algorithm>
#include <vector>

#include "support/threads/parallel.h"

namespace saddleback {

/// Calls body(i, found) for i in [0, count) from `threads` threads, `chunk` neighboring indices at a time, and appends
/// what these put into `found` to `all`, in the order of i.
template <class T, class Body>
void append_in_order(std::vector<T>& all, Index count, int threads, Index chunk, Body&& body) {
  std::vector<std::vector<T>> parts(static_cast<std::size_t>((count + chunk - 1) / chunk));
  parallel_for(static_cast<Index>(parts.size()), threads, 1, [&](Index part, int) {
    const Index end = std::min(count, (part + 1) * chunk);
    for (Index i = part * chunk; i < end; ++i) body(i, parts[part]);
  });
  std::size_t size = all.size();
  for (const std::vector<T>& part : parts) size += part.size();
  all.reserve(size);
  for (const std::vector<T>& part : parts) all.insert(all.end(), part.begin(), part.end());
}

}  // namespace saddleback
