#pragma once
// The checks of options that all ways to a diagram of the plane share.

#include <cstddef>

#include "saddleback/error.h"
#include "saddleback/voronoi2d/voronoi_2d.h"

namespace saddleback::voronoi2d {

inline void check_options(const Voronoi2dOptions& options, std::size_t site_count) {
  if (options.circles < 0) throw InputError(message("circles: wanted 0 or more, got ", options.circles));
  if (options.threads < 0) throw InputError(message("threads: wanted 0 or more, got ", options.threads));
  constexpr std::size_t k_most = 300'000'000;  // six neighbors each are counted in 32 bits
  if (site_count > k_most) throw InputError(message("sites: wanted up to ", k_most, ", got ", site_count));
}

}  // namespace saddleback::voronoi2d
