#pragma once
// Relaxations whose sites do not depend on how large the mesh is and where it lies.

#include <functional>

#include "tessellation/relaxation/diagram.h"

namespace saddleback {

/// A relaxation on a graph.
using Relax = std::function<CentroidalVoronoi(const SaddleVertexGraph&, const CentroidalVoronoiOptions&,
                                              const JobStage&, FinalCells)>;

/// Calls `relax` with the graph of the mesh at unit size and options that say the same there, then finds the cells of
/// the sites on the graph itself. With the graph and the options as they are where nothing moves, the options do not
/// want it or there is no such graph. `count` sites, for those who watch. \throw Cancelled, as `relax` and
/// centroidal_voronoi.
CentroidalVoronoi relax_at_unit_size(const SaddleVertexGraph& graph, std::size_t count,
                                     const CentroidalVoronoiOptions& options, const JobStage& stage,
                                     const Relax& relax);

}  // namespace saddleback
