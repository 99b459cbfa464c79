#pragma once
// Threads: one loop, dynamic scheduling, errors carried to the caller.

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>

#include "saddleback/types.h"

#include "support/threads/thread_team.h"

namespace saddleback {

/// Bytes that threads fetch from each other's memory together: what only one of them writes lies so far from the rest.
inline constexpr std::size_t k_apart = 128;

/// Limits on the threads begun, whatever is asked for: more would only take memory and time from each other.
inline constexpr int k_threads_per_processor = 4, k_always_allowed_threads = 64;

/// Number of threads to use for a request (0: all cores; far more than there are cores: as many as make sense).
inline int thread_count(int requested) {
  const int processors = processor_count();
  if (requested <= 0) return processors;
  return std::min(requested, std::max(k_always_allowed_threads, k_threads_per_processor * processors));
}

/// Calls body(i, thread) for i in [0, count) from `threads` threads, `chunk` neighboring indices at a time.
/// The first exception stops the loop soon and is rethrown here. The order of calls is not defined: results must not
/// depend on it. `thread` is less than the number of threads and than the number of chunks.
template <class Body>
void parallel_for(Index count, int threads, Index chunk, Body&& body) {
  const std::int64_t chunks = (std::int64_t{count} + chunk - 1) / chunk;
  const auto team = static_cast<int>(std::min<std::int64_t>(thread_count(threads), chunks));
  if (team <= 1) {
    for (Index i = 0; i < count; ++i) body(i, 0);
    return;
  }
  std::exception_ptr error;
  std::atomic<bool> failed{false};
  struct alignas(k_apart) Next {
    std::atomic<std::int64_t> begin{0};
  } next;
  auto work = [&](int thread) noexcept {
    try {
      for (std::int64_t begin = 0; (begin = next.begin.fetch_add(chunk, std::memory_order_relaxed)) < count;) {
        const auto end = static_cast<Index>(std::min<std::int64_t>(begin + chunk, count));
        for (auto i = static_cast<Index>(begin); i < end; ++i) {
          if (failed.load(std::memory_order_relaxed)) return;
          body(i, thread);
        }
      }
    } catch (...) {
      if (!failed.exchange(true)) error = std::current_exception();
    }
  };
  run_team(team, {[](void* context, int thread) { (*static_cast<decltype(work)*>(context))(thread); }, &work});
  if (error) std::rethrow_exception(error);
}

}  // namespace saddleback
