#pragma once
// The nearest of many sources for every node of a graph, where nearly all of it is known.

#include <limits>
#include <span>
#include <vector>

#include "saddleback/geodesics/saddle_vertex_graph.h"
#include "saddleback/support/large_array.h"

#include "geodesics/queries/relax_row.h"

namespace saddleback {

/// Finds what nearest_sources finds, where sources lie close to each other: some dozen nodes or fewer for each. All
/// nodes are expanded in the order of memory, then those whose distance fell, until none falls; an arc that leads
/// farther than the farthest node is from its source serves nothing, so that of each row the shortest arcs mostly do,
/// which lie apart. Holds its memory for the next run.
class NearestSweep {
 public:
  /// The graph must outlive it. O(arcs) by `threads` threads (0: all cores), 136 bytes a node. \throw Cancelled
  NearestSweep(const SaddleVertexGraph& graph, int threads, const JobStage& stage);

  /// Distances along some path from a source, or infinity and k_none, become the least there are, with the least source
  /// among equals. False where nodes remain out of reach of the shortest arcs: then distances are along paths still,
  /// but not all are the least. The same for any number of threads. \throw Cancelled
  bool run(std::span<double> distances, std::span<Index> sources, const JobStage& stage);

 private:
  static constexpr Index k_near = 16;
  struct Offer {
    Index node, source;
    double distance;
  };
  /// A stretch of nodes, and what one thread finds and writes.
  struct Part {
    Index first, last;
    std::vector<Index> front;                ///< to be expanded
    std::vector<std::vector<Offer>> offers;  ///< by the part that their nodes belong to
  };
  /// The row's words that are looked at: all arcs but those that lead farther than any node is from its source.
  std::span<const std::uint64_t> useful_arcs(Index node, double distance) const;
  void list_nearest(Index node);
  void expand(Part& part, const JobStage& stage);
  void take_offers(Index part);
  void expand_until_none_falls(const JobStage& stage);
  bool find_farthest();
  Index part_of(Index node) const;
  template <class Body>
  void for_each_part(Body&& body);

  const SaddleVertexGraph& graph_;
  const int threads_;
  const FindCandidates find_candidates_;
  LargeArray<std::uint64_t> near_;   ///< k_near words a node
  std::vector<double> left_out_;     ///< the shortest arc that is not among those
  std::vector<std::uint8_t> waits_;  ///< by node: it is in a front
  std::vector<Part> parts_;
  // Of one run:
  std::span<double> distances_;
  std::span<Index> sources_;
  double farthest_ = 0;  ///< no node will be farther from its source
};

}  // namespace saddleback
