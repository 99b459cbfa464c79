#pragma once
// Shortest paths in the graph from many seeds at once, as fields over the vertices.

#include <span>
#include <vector>

#include "geodesics/graph_search.h"

namespace saddleback {

struct LabelField {
  std::vector<double> distance;  ///< infinity where nothing reaches
  std::vector<Index> source;     ///< k_none where nothing reaches; ties: the smaller source
  std::vector<Index>
      predecessor;  ///< vertex before on the path; k_none: straight from the source. Empty unless asked for
};

/// Least distance and, among equals, least source for every vertex: label-correcting with buckets, or Dijkstra's heap.
/// Works in the order of the nodes inside (see GraphSearch); seeds and fields are vertices. Whoever follows few paths
/// needs no predecessors: the sums being exact, previous_vertex finds them from the distances.
LabelField propagate_labels(const SaddleVertexGraph& graph, std::span<const Seed> seeds, const QueryOptions& options,
                            bool with_predecessors, const JobStage& stage);

/// The vertex before `vertex` on a shortest path, from distances of all vertices (a whole field's, or a search's that
/// has reached the vertex): the neighbour whose distance plus the arc is that of `vertex` to the bit; of several the
/// one with the longest arc, then the smallest node. k_none when there is none: the vertex is a seed. With sources, the
/// neighbour's must be the same. `arc` gets the arc from the vertex back to it. O(degree).
Index previous_vertex(const SaddleVertexGraph& graph, std::span<const double> distance, std::span<const Index> source,
                      Index vertex, std::int64_t* arc = nullptr);

}  // namespace saddleback
