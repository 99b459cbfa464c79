#pragma once
// How long edges usually are.

#include "saddleback/mesh/mesh.h"

namespace saddleback {

/// Length that about this share of the edges, from 0 to below 1, fall short of; from a sample. O(1).
double edge_length_at(const Mesh& mesh, double share);

/// About the median of the edges' lengths, which a few huge faces do not change as they do the mean. O(1).
double common_length(const Mesh& mesh);

}  // namespace saddleback
