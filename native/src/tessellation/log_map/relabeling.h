#pragma once
// The nearest sources of a graph's nodes after some of the sources have moved.

#include <limits>
#include <span>
#include <vector>

#include "saddleback/geodesics/saddle_vertex_graph.h"

#include "geodesics/graph/arc_rows.h"

namespace saddleback {

/// Repairs what nearest_sources found, where that is wrong now. Nodes whose source has moved are loosened; what the
/// sources see of nodes is offered; the search then goes no farther than something changes. The other nodes' shortest
/// paths lead over nodes of the same source alone, and so hold still; lengths of arcs sum up without rounding, so the
/// result has the same bits.
///
/// After [frigioni2000].
class Relabeling {
 public:
  /// `distances` and `sources`, by node, are written to. All must outlive it.
  Relabeling(const SaddleVertexGraph& graph, std::vector<double>& distances, std::vector<Index>& sources)
      : graph_(graph), distances_(distances), sources_(sources), best_(distances.size()) {}

  /// Nodes that belong to no source until they are reached anew.
  void loosen(std::span<const Index> nodes);
  /// A way from a source. Those that serve for nothing cost nothing.
  void offer(Index node, Index source, double distance);
  /// Calls changed(source) for every source that gets a node or loses one, often more than once. \throw Cancelled.
  /// O(arcs of nodes that change, logarithms for their order).
  template <class Changed>
  void run(const JobStage& stage, Changed&& changed);

 private:
  struct Offer {
    double distance = std::numeric_limits<double>::infinity();
    Index source = k_none, node = k_none;
    /// The nearest on top of a heap; among equals the smallest source.
    bool operator<(const Offer& other) const {
      return distance != other.distance ? distance > other.distance : source > other.source;
    }
  };
  static bool serves(const Offer& offer, double distance, Index source) {
    return offer.distance < distance || (offer.distance == distance && offer.source < source);
  }
  bool next(Offer& offer);

  const SaddleVertexGraph& graph_;
  std::vector<double>& distances_;
  std::vector<Index>& sources_;
  std::vector<Offer> best_;  ///< by node: a node has a hundred neighbors, of whose offers few are waited for
  std::vector<Offer> heap_;
};

template <class Changed>
void Relabeling::run(const JobStage& stage, Changed&& changed) {
  constexpr std::size_t k_between_checks = 4096;
  const ArcRows& arcs = graph_.arcs();
  std::size_t steps = 0;
  for (Offer best; next(best);) {
    if (++steps % k_between_checks == 0) stage.check();
    changed(best.source);
    if (sources_[best.node] != k_none) changed(sources_[best.node]);
    distances_[best.node] = best.distance;
    sources_[best.node] = best.source;
    for (std::int64_t arc = arcs.first(best.node); arc < arcs.first(best.node + 1); ++arc)
      offer(arcs.target(arc), best.source, best.distance + arcs.length(arc));
  }
}

}  // namespace saddleback
