#pragma once
// How long the edges of a dual mesh are on the surface.

#include <vector>

#include "saddleback/geodesic_voronoi.h"

namespace saddleback {

/// As `DualMesh::edge_lengths`, one for each open boundary. \throw Cancelled. O(faces crossed) each.
std::vector<double> dual_edge_lengths(const Mesh& mesh, const GeodesicVoronoi& cells, int threads,
                                      const JobStage& stage);

}  // namespace saddleback
