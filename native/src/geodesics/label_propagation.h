#pragma once
// Shortest paths in the graph from many seeds at once.

#include <vector>

#include "saddleback/saddle_vertex_graph.h"

namespace saddleback {

/// A vertex that a source reaches by an arc of its own.
struct Seed {
  Index vertex;
  Index source;
  double distance;
};

struct LabelField {
  std::vector<double> distance;  ///< infinity where nothing reaches
  std::vector<Index> source;     ///< k_none where nothing reaches; ties: the smaller source
  std::vector<Index>
      predecessor;  ///< vertex before on the path; k_none: straight from the source. Empty unless asked for
};

/// Least distance and, among equals, least source for every vertex: label-correcting with buckets, or Dijkstra's heap.
LabelField propagate_labels(const SaddleVertexGraph& graph, const std::vector<Seed>& seeds, const QueryOptions& options,
                            bool with_predecessors, const JobStage& stage);

}  // namespace saddleback
