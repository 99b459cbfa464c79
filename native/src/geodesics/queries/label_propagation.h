#pragma once
// Shortest paths in the graph from many seeds at once, as fields over the vertices.

#include <span>
#include <vector>

#include "geodesics/queries/graph_search.h"

namespace saddleback {

struct LabelField {
  std::vector<double> distance;  ///< infinity where nothing reaches
  std::vector<Index> source;     ///< k_none where nothing reaches; ties: the smaller source
  std::vector<Index>
      predecessor;  ///< vertex before on the path; k_none: straight from the source. Empty unless asked for
};

/// Least distance and, among equals, least source for every vertex: label-correcting with buckets, or Dijkstra's heap.
/// Works in the order of the nodes inside (see GraphSearch); seeds and fields are vertices.
LabelField propagate_labels(const SaddleVertexGraph& graph, std::span<const Seed> seeds, const QueryOptions& options,
                            bool with_predecessors, const JobStage& stage);

}  // namespace saddleback
