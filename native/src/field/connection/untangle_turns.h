#pragma once
// Turns that are too sharp for directions alone to tell them.

#include <vector>

#include "saddleback/mesh/mesh.h"

namespace saddleback {

/// Turns faces about where the field turns by more than nearly pi / symmetry between two faces (not those that are
/// `fixed`) so that the largest turn of each becomes least. No index changes, as every turn taken from one side of a
/// face is given to the others. Where a vertex of few faces has to turn too fast whatever one does, some stay sharp.
void untangle_turns(const Mesh& mesh, int symmetry, const std::vector<bool>& fixed, std::vector<double>& angles,
                    std::vector<double>& turns);

}  // namespace saddleback
