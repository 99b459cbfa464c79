#include "tessellation/log_map/relabeling.h"

#include <algorithm>
#include <limits>

namespace saddleback {

void Relabeling::loosen(std::span<const Index> nodes) {
  for (const Index node : nodes) {
    distances_[node] = std::numeric_limits<double>::infinity();
    sources_[node] = k_none;
  }
  const ArcRows& arcs = graph_.arcs();
  for (const Index node : nodes) {
    for (std::int64_t arc = arcs.first(node); arc < arcs.first(node + 1); ++arc) {
      const Index other = arcs.target(arc);
      if (sources_[other] != k_none) offer(node, sources_[other], distances_[other] + arcs.length(arc));
    }
  }
}

void Relabeling::offer(Index node, Index source, double distance) {
  const Offer offered{distance, source, node};
  if (!serves(offered, distances_[node], sources_[node])) return;
  Offer& best = best_[node];
  if (!serves(offered, best.distance, best.source)) return;
  best = offered;
  heap_.push_back(offered);
  std::push_heap(heap_.begin(), heap_.end());
}

/// The nearest offer that still serves for something.
bool Relabeling::next(Offer& offer) {
  while (!heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end());
    offer = heap_.back();
    heap_.pop_back();
    if (serves(offer, distances_[offer.node], sources_[offer.node])) return true;
  }
  return false;
}

}  // namespace saddleback
