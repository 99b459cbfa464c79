#pragma once
// The graph opened: its arcs by vertices, with their directions, and in the tiers of the paper.

#include <cstdint>
#include <vector>

#include "saddleback/geodesics/saddle_vertex_graph.h"

namespace saddleback {

/// All arcs in compressed sparse rows, both ways: those of vertex v are [offsets[v], offsets[v + 1]), by target.
struct GraphArcs {
  std::vector<std::int64_t> offsets;
  std::vector<Index> targets;
  std::vector<double> lengths;
};

/// \throw InputError for a damaged file that the graph is mapped from; Cancelled. O(arcs log degree).
GraphArcs graph_arcs(const SaddleVertexGraph& graph, Job* job = nullptr);

/// The vertices that one is linked to, ascending.
struct GraphNeighbors {
  std::vector<Index> vertices;
  std::vector<double> lengths;
  std::vector<double> angles;  ///< in which the arcs leave, radians, as `trace` takes them
};

/// \throw InputError for a vertex out of range. O(degree times faces crossed).
GraphNeighbors graph_neighbors(const SaddleVertexGraph& graph, Index vertex);

/// Returns the kind (V,) of each vertex: -1 saddle, more than a full turn about it or on the boundary, where shortest
/// paths may bend; 0 Euclidean, a full turn to 1e-10; 1 spherical, less. O(V).
std::vector<std::int8_t> vertex_kinds(const Mesh& mesh);

/// Arcs by their ends, each counted once: between saddle vertices, from one to another vertex, between others.
struct ArcTiers {
  std::int64_t between_saddles = 0, to_saddles = 0, between_others = 0;
};

/// O(arcs).
ArcTiers arc_tiers(const SaddleVertexGraph& graph);

}  // namespace saddleback
