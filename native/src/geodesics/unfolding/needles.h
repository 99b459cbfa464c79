#pragma once
// Meshes with many long and thin faces, on which all that goes by windows takes longer than its vertices tell.

#include "saddleback/mesh/mesh.h"

namespace saddleback {

/// Whether a tenth of some thousand faces are twenty times as long as high, or more. O(1).
bool has_needles(const Mesh& mesh);
/// How many times as long as elsewhere it takes, about, to find what a point or a curve sees: 1 without needles. O(1).
double needle_factor(const Mesh& mesh);

}  // namespace saddleback
