#pragma once
// A manifold triangle list as OpenMesh's half-edges, for the work that changes connectivity.

// OpenMesh's headers come first: they mind what is defined before them.
#include <OpenMesh/Core/Mesh/TriConnectivity.hh>
#include <span>

#include "saddleback/types.h"

namespace saddleback {

/// Fills OpenMesh's kernel through its own elements: `add_face` would search around every corner for what the edge
/// table already knows. Vertices and faces keep their numbers. Status flags are requested, so that elements can be
/// deleted. \pre manifold and consistently oriented; every vertex in some face.
void fill_halfedges(OpenMesh::TriConnectivity& mesh, std::span<const Triangle> triangles, Index vertex_count);

}  // namespace saddleback
