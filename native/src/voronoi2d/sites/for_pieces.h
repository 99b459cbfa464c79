#pragma once
// Work on many things, a few thousand in a row at a time.

#include <algorithm>
#include <cstddef>

#include "saddleback/job.h"
#include "saddleback/types.h"

#include "support/threads/parallel.h"

namespace saddleback::voronoi2d {

inline constexpr std::size_t k_piece = std::size_t{1} << 14;

/// Calls work(piece, begin, end) for each piece of `count` things, side by side.
template <class Work>
void for_pieces(std::size_t count, int threads, const JobStage& stage, Work&& work) {
  const Index pieces = static_cast<Index>((count + k_piece - 1) / k_piece);
  parallel_for(pieces, threads, 1, [&](Index piece, int) {
    stage.update(piece / static_cast<double>(pieces));
    const std::size_t begin = piece * k_piece;
    work(piece, begin, std::min(count, begin + k_piece));
  });
  stage.update(1);
}

}  // namespace saddleback::voronoi2d
