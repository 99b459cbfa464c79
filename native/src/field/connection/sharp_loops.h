#pragma once
// Ways around which a field turns faster than directions can tell.

#include <span>
#include <vector>

#include "saddleback/mesh/mesh.h"

namespace saddleback {

/// The largest mean turn along a loop that leaves its edges room to stay below pi / symmetry, as a share of that.
inline constexpr double k_told_share = 0.95;

/// Loops over faces, each the half-edges that it crosses, along which the field turns by more than k_told_share of
/// pi / symmetry an edge. Turning faces about changes no such sum, so that some edge of each stays sharp. No face is in
/// two of them; empty where faces can be turned about so that no edge is sharp. Negative circles of the difference
/// constraints between faces (Bellman and Ford), searched for from sharp edges only: O(F) to find those, then as much
/// as they reach around.
std::vector<std::vector<Index>> sharp_loops(const Mesh& mesh, int symmetry, std::span<const double> turns);

}  // namespace saddleback
