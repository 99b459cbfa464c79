#pragma once
// Memory that a device is about to write.

#include <algorithm>
#include <cstddef>
#include <span>

#include "saddleback/job.h"
#include "saddleback/types.h"

#include "support/parallel.h"

namespace saddleback {

/// Makes the system lay pages under memory that nobody wrote yet, by all threads: a device's copy would wait for it.
/// \throw Cancelled
inline void lay_pages(std::span<std::byte> memory, int threads, const JobStage& stage) {
  constexpr std::size_t k_page = 4096, k_piece = std::size_t{1} << 21;
  const auto pieces = static_cast<Index>((memory.size() + k_piece - 1) / k_piece);
  parallel_for(pieces, threads, 1, [&](Index piece, int) {
    stage.check();
    const std::size_t begin = static_cast<std::size_t>(piece) * k_piece, end = std::min(begin + k_piece, memory.size());
    for (std::size_t i = begin; i < end; i += k_page) memory[i] = std::byte{0};
  });
}

}  // namespace saddleback
