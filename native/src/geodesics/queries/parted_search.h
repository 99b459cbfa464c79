#pragma once
// The nearest of many sources for every node of a graph, by several threads.

#include <functional>
#include <vector>

#include "geodesics/queries/graph_search.h"

namespace saddleback {

/// Appends the seeds whose nodes are from `first` up to `last`. Called by several threads at once.
using SeedsOfPart = std::function<void(Index first, Index last, std::vector<NodeSeed>& seeds)>;

/// Least distance and, among equals, least source of every node, infinity and k_none where nothing reaches: what a
/// GraphSearch finds, for any number of threads. \throw Cancelled. O(arcs), and O(V) a thread.
void nearest_sources(const SaddleVertexGraph& graph, const SeedsOfPart& seeds_of, int threads, const JobStage& stage,
                     std::vector<double>& distances, std::vector<Index>& sources);

}  // namespace saddleback
