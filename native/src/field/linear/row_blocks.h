#pragma once
// Loops over rows and sums over them that are the same for any number of threads.

#include <algorithm>
#include <array>
#include <vector>

#include "saddleback/job.h"

#include "support/threads/parallel.h"

namespace saddleback {

/// Rows that one thread takes at a time: some microseconds of work, so that coarse levels have some for each thread.
inline constexpr Index k_rows_a_block = 512;

/// Calls body(i) for the rows from `begin` to `end`, in blocks by several threads (0: all cores).
template <class Body>
void for_rows(Index begin, Index end, int threads, Body&& body) {
  const Index count = (end - begin + k_rows_a_block - 1) / k_rows_a_block;
  parallel_for(count, threads, 1, [&](Index block, int) {
    const Index first = begin + block * k_rows_a_block, last = std::min(end, first + k_rows_a_block);
    for (Index i = first; i < last; ++i) body(i);
  });
}

/// Returns the sums of what body(i, sums) adds to them for the rows from 0 to `count`: those of the blocks, one after
/// the other.
template <class Sums, class Body>
Sums sums_of_rows(Index count, int threads, Body&& body) {
  std::vector<Sums> parts((count + k_rows_a_block - 1) / k_rows_a_block, Sums{});
  parallel_for(static_cast<Index>(parts.size()), threads, 1, [&](Index block, int) {
    Sums own{};
    const Index first = block * k_rows_a_block, last = std::min(count, first + k_rows_a_block);
    for (Index i = first; i < last; ++i) body(i, own);
    parts[block] = own;
  });
  Sums result{};
  for (const Sums& part : parts)
    for (std::size_t k = 0; k < part.size(); ++k) result[k] += part[k];
  return result;
}

/// Nodes that setting up treats one after the other, in their order; all such stretches at the same time.
inline constexpr Index k_stretch = 8192;

/// Calls body(begin, end) for each stretch of nodes, by several threads.
template <class Body>
void for_stretches(Index count, const JobStage& stage, Body&& body) {
  parallel_for((count + k_stretch - 1) / k_stretch, 0, 1, [&](Index stretch, int) {
    stage.check();
    body(stretch * k_stretch, std::min(count, (stretch + 1) * k_stretch));
  });
}

/// Splits the threads between loops over tasks and those over rows within each: where tasks are fewer than threads, one
/// task after the other is done by all.
struct NestedThreads {
  explicit NestedThreads(Index count) : tasks(count < thread_count(0) ? 1 : 0), rows(1 - tasks) {}
  int tasks, rows;
};

}  // namespace saddleback
