#include "tessellation/baking/margin.h"

#include <atomic>
#include <cstdint>
#include <limits>

#include "saddleback/support/large_array.h"

#include "support/threads/parallel.h"

namespace saddleback {
namespace {

constexpr std::int16_t k_far = std::numeric_limits<std::int16_t>::max();
constexpr Index k_columns = 256;  ///< that a thread looks at together
constexpr double k_columns_done = 0.3;

}  // namespace

void fill_margin(Index width, Index height, Index margin, int threads, const std::function<bool(std::size_t)>& is_drawn,
                 const std::function<void(std::size_t, std::size_t)>& copy, const JobStage& stage) {
  if (margin <= 0) return;
  // How many rows up (negative: down) the nearest drawn texel of the column is.
  LargeArray<std::int16_t> rows_to(std::size_t(width) * height);
  const Index stripes = (width + k_columns - 1) / k_columns;
  parallel_for(stripes, threads, 1, [&](Index stripe, int) {
    const Index begin = stripe * k_columns, end = std::min(width, begin + k_columns);
    for (Index y = 0; y < height; ++y) {
      if (y % 64 == 0) stage.check();
      for (Index x = begin; x < end; ++x) {
        const std::size_t texel = std::size_t(y) * width + x;
        const std::int16_t below = y > 0 ? rows_to[texel - width] : k_far;
        rows_to[texel] = is_drawn(texel) ? 0 : below == k_far || -below >= margin ? k_far : std::int16_t(below - 1);
      }
    }
    for (Index y = height - 2; y >= 0; --y) {
      if (y % 64 == 0) stage.check();
      for (Index x = begin; x < end; ++x) {
        const std::size_t texel = std::size_t(y) * width + x;
        const std::int16_t above = rows_to[texel + width];
        if (above < 0 || above == k_far || above >= margin) continue;
        if (rows_to[texel] == k_far || -rows_to[texel] > above + 1) rows_to[texel] = std::int16_t(above + 1);
      }
    }
  });
  std::atomic<Index> done{0};
  parallel_for(height, threads, 4, [&](Index y, int) {
    stage.check();
    for (Index x = 0; x < width; ++x) {
      const std::size_t texel = std::size_t(y) * width + x;
      if (rows_to[texel] == 0) continue;
      std::int64_t least = std::int64_t{margin} * margin + 1;
      std::size_t from = texel;
      for (Index step = 0; step <= margin && std::int64_t{step} * step < least; ++step) {
        for (const Index at : {x - step, x + step}) {
          if (at < 0 || at >= width) continue;
          const std::int64_t rows = rows_to[texel - x + at];
          if (rows == k_far || std::int64_t{step} * step + rows * rows >= least) continue;
          least = std::int64_t{step} * step + rows * rows;
          from = texel - x + at + static_cast<std::size_t>(rows * width);
        }
      }
      if (from != texel) copy(texel, from);
    }
    const Index ready = done.fetch_add(1, std::memory_order_relaxed) + 1;
    stage.update(k_columns_done + (1 - k_columns_done) * ready / height);
  });
}

}  // namespace saddleback
