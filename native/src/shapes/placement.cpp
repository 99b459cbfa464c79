#include "saddleback/shapes/placement.h"

#include <cmath>

#include "saddleback/error.h"

namespace saddleback {

void check_placements(const Mesh& mesh, std::size_t shape_count, std::span<const Placement> placements) {
  for (std::size_t i = 0; i < placements.size(); ++i) {
    const Placement& placement = placements[i];
    if (placement.shape < 0 || static_cast<std::size_t>(placement.shape) >= shape_count)
      throw InputError(message("placements: shape ", placement.shape, " at [", i, "] is out of range, there are ",
                               shape_count, " shapes"));
    if (!std::isfinite(placement.angle))
      throw InputError(message("placements: angle ", placement.angle, " at [", i, "] is not finite"));
    if (!(placement.scale > 0) || !std::isfinite(placement.scale))
      throw InputError(message("placements: scale ", placement.scale, " at [", i, "] is not positive and finite"));
    check_surface_point(mesh, placement.center, "placements");
  }
}

}  // namespace saddleback
