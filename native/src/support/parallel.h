#pragma once
// Threads: one loop, dynamic scheduling, errors carried to the caller.

#include <algorithm>
#include <atomic>
#include <exception>
#include <omp.h>

#include "saddleback/types.h"

namespace saddleback {

/// Number of threads to use for a request (0: all cores).
inline int thread_count(int requested) { return requested > 0 ? requested : std::max(1, omp_get_num_procs()); }

/// Calls body(i, thread) for i in [0, count) from `threads` threads, `chunk` neighbouring indices at a time.
/// The first exception stops the loop soon and is rethrown here. The order of calls is not defined: results must not
/// depend on it.
template <class Body>
void parallel_for(Index count, int threads, Index chunk, Body&& body) {
  const int team =
      static_cast<int>(std::min<Index>(thread_count(threads), std::max<Index>(1, (count + chunk - 1) / chunk)));
  if (team == 1) {  // a team of one costs microseconds
    for (Index i = 0; i < count; ++i) body(i, 0);
    return;
  }
  std::exception_ptr error;
  std::atomic<bool> failed{false};
#pragma omp parallel for schedule(dynamic, chunk) num_threads(team)
  for (Index i = 0; i < count; ++i) {
    if (failed.load(std::memory_order_relaxed)) continue;
    try {
      body(i, omp_get_thread_num());
    } catch (...) {
      if (!failed.exchange(true)) error = std::current_exception();
    }
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace saddleback
