#pragma once
// The lengths of the steps of a search through a graph.

#include "geodesics/graph/arc_rows.h"

namespace saddleback {

/// Length that this share of the nodes' shortest arcs do not exceed, from a sample of the nodes. On graded meshes most
/// nodes are where edges are short, far below the mean. O(degree).
double shortest_arcs_below(const ArcRows& arcs, double share);

}  // namespace saddleback
