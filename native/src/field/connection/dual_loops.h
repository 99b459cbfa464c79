#pragma once
// Ways from face to face: a tree over each component, and the loops around its handles.

#include <vector>

#include "field/connection/filled_surface.h"

namespace saddleback {

struct DualLoops {
  /// Faces from each component's smallest face outwards; each but those is entered across the half-edge `entered_by`
  /// (a half-edge of the face it is entered from), k_none for those.
  std::vector<Index> order, entered_by;
  /// Loops, 2 genus of them for each component: the half-edges that each crosses, in order, every one of the face being
  /// left.
  std::vector<std::vector<Index>> loops;
  std::vector<Index> component_of_loop;
};

/// Tree-cotree decomposition: breadth-first trees over faces, and of the edges that they do not cross a forest over
/// nodes that prefers edges of long loops, so that short ones are left [eppstein2003], [erickson2005]. O(F) and the
/// length of the loops.
DualLoops dual_loops(const Mesh& mesh, const FilledSurface& filled);

}  // namespace saddleback
