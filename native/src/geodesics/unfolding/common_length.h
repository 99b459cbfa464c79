#pragma once
// The usual length of edges.

#include "saddleback/mesh/mesh.h"

namespace saddleback {

/// Returns about the median of the edges' lengths, from a sample; a few huge faces do not change it as they do the
/// mean. O(1).
double common_length(const Mesh& mesh);

}  // namespace saddleback
