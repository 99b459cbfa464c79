#pragma once
// Threads: one loop, dynamic scheduling, errors carried to the caller.

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <omp.h>

#include "saddleback/types.h"

namespace saddleback {

/// Bytes that threads fetch from each other's memory together: what only one of them writes lies so far from the rest.
inline constexpr std::size_t k_apart = 128;

/// Number of threads to use for a request (0: all cores).
inline int thread_count(int requested) { return requested > 0 ? requested : std::max(1, omp_get_num_procs()); }

/// Calls body(i, thread) for i in [0, count) from `threads` threads, `chunk` neighbouring indices at a time.
/// The first exception stops the loop soon and is rethrown here. The order of calls is not defined: results must not
/// depend on it. `thread` is less than the number of threads and than the number of chunks.
///
/// All threads are called, also where there are fewer chunks: GNU's OpenMP ends those that a smaller team leaves out,
/// and begins them anew for the next larger one, which takes longer than most loops.
template <class Body>
void parallel_for(Index count, int threads, Index chunk, Body&& body) {
  const int all = thread_count(threads);
  const auto team = static_cast<int>(std::min<std::int64_t>(all, (std::int64_t{count} + chunk - 1) / chunk));
  if (team <= 1) {  // a team of one costs microseconds
    for (Index i = 0; i < count; ++i) body(i, 0);
    return;
  }
  std::exception_ptr error;
  std::atomic<bool> failed{false};
  struct alignas(k_apart) Next {
    std::atomic<std::int64_t> begin{0};
  } next;
  const auto work = [&](int thread) {
    for (std::int64_t begin = 0; (begin = next.begin.fetch_add(chunk, std::memory_order_relaxed)) < count;) {
      const auto end = static_cast<Index>(std::min<std::int64_t>(begin + chunk, count));
      for (auto i = static_cast<Index>(begin); i < end; ++i) {
        if (failed.load(std::memory_order_relaxed)) return;
        body(i, thread);
      }
    }
  };
#pragma omp parallel num_threads(all)
  if (const int thread = omp_get_thread_num(); thread < team) {
    try {
      work(thread);
    } catch (...) {
      if (!failed.exchange(true)) error = std::current_exception();
    }
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace saddleback
