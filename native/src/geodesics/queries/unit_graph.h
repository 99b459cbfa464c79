#pragma once
// The same graph whatever the size and the place of the mesh.

#include <memory>

#include "saddleback/geodesics/saddle_vertex_graph.h"

namespace saddleback {

/// The graph of a mesh moved and scaled into the cube from -1 to 1, its coordinates rounded to 2^-26: the same bits for
/// the mesh enlarged, shrunk or moved by any amount, whose own coordinates and lengths are rounded differently.
/// Roundings matter where two ways are equally long, and in what goes on from there: after a hundred steps sites may be
/// anywhere else.
struct UnitGraph {
  Mesh mesh;
  double size;  ///< lengths of the given mesh are so many times those of this one
  SaddleVertexGraph graph;

  /// `there` is the mesh in the cube. `cuda_device` finds the arcs, -1: the processor does. \throw as the graph's
  /// constructor.
  UnitGraph(Mesh there, double size, const SaddleVertexGraph& graph, int threads, int cuda_device,
            const JobStage& stage);
};

/// None where the graph's mesh is in that cube and rounded already, where rounding would change what it looks like (its
/// edges are short against the whole, or faces needles), or where the graph is larger than 128 MB. As long as building
/// the graph took. \throw Cancelled; DeviceError.
std::unique_ptr<const UnitGraph> unit_graph(const SaddleVertexGraph& graph, int threads, int cuda_device,
                                            const JobStage& stage);

}  // namespace saddleback
