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
  if (distance > distances_[node] || (distance == distances_[node] && source >= sources_[node])) return;
  heap_.push_back({distance, source, node});
  std::push_heap(heap_.begin(), heap_.end());
}

/// The nearest offer that still serves for something.
bool Relabeling::next(Offer& offer) {
  while (!heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end());
    offer = heap_.back();
    heap_.pop_back();
    const double distance = distances_[offer.node];
    if (offer.distance < distance || (offer.distance == distance && offer.source < sources_[offer.node])) return true;
  }
  return false;
}

}  // namespace saddleback
