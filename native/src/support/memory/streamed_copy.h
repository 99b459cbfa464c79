#pragma once
// Copying to memory that nobody reads soon.

#include <cstddef>
#include <cstdint>
#include <cstring>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace saddleback {

/// Copies as std::memcpy, but past the caches: what is overwritten is not fetched before, which makes a copy of what
/// was just read from a device half as long.
inline void copy_past_caches(void* to, const void* from, std::size_t size) {
  char* out = static_cast<char*>(to);
  const char* in = static_cast<const char*>(from);
#if defined(__SSE2__)
  constexpr std::size_t k_line = 64, k_ahead = 1024;
  const std::size_t head = (k_line - reinterpret_cast<std::uintptr_t>(out) % k_line) % k_line;
  if (size >= head + k_line) {
    std::memcpy(out, in, head);
    out += head;
    in += head;
    size -= head;
    for (; size >= k_line; out += k_line, in += k_line, size -= k_line) {
      _mm_prefetch(in + k_ahead, _MM_HINT_NTA);
      __m128i quarters[4];
      for (int i = 0; i < 4; ++i) quarters[i] = _mm_loadu_si128(reinterpret_cast<const __m128i*>(in) + i);
      for (int i = 0; i < 4; ++i) _mm_stream_si128(reinterpret_cast<__m128i*>(out) + i, quarters[i]);
    }
    _mm_sfence();  // a thread that learns that the copy is done has to find it
  }
#endif
  std::memcpy(out, in, size);
}

}  // namespace saddleback
