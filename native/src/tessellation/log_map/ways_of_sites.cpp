#include "tessellation/log_map/ways_of_sites.h"

#include <utility>

namespace saddleback {

/// Begins a search with what a site sees straight: no longer than it is, and nothing that is hidden.
WaysOfSites::Search WaysOfSites::begin(Index site) {
  Search search{{}, std::pmr::unordered_map<Index, Search::Reached>(&memory_)};
  const auto push = [&](Index node, const PackedVec2& at) {
    search.push({at.norm(), node, at.norm() > 0 ? PackedVec2(at.normalized()) : PackedVec2(1, 0)});
  };
  const SeenVertices& seen = maps_.seen().of(site);
  if (seen.center != k_none) push(seen.center, PackedVec2(PackedVec2::Zero()));
  for (std::size_t i = 0; i < seen.nodes.size(); ++i) push(seen.nodes[i], seen.places[i]);
  if (seen.center != k_none) return search;
  const SurfacePoint& place = maps_.labels().sites()[site];
  const FaceChart chart(maps_.graph().mesh(), place.face);
  for (std::size_t i = 0; i < 3; ++i)
    push(seen.corners[i], PackedVec2(chart.corner[i] - chart.to_plane(place.barycentric)));
  return search;
}

/// Takes in a way unless one as short is known: vertices of large faces have many arcs, most of them of no use.
void WaysOfSites::Search::push(const Step& step) {
  double& known = reached[step.node].distance;
  if (known <= step.distance) return;
  known = step.distance;
  queue.push(step);
}

PackedVec2 WaysOfSites::find(Index site, Index node) {
  auto entry = searches_.find(site);
  if (entry == searches_.end()) entry = searches_.emplace(site, begin(site)).first;
  Search& search = entry->second;
  const ArcRows& arcs = maps_.graph().arcs();
  while (true) {
    if (const auto found = search.reached.find(node); found != search.reached.end() && found->second.is_settled)
      return found->second.place;
    const Search::Step step = search.queue.top();
    search.queue.pop();
    Search::Reached& reached = search.reached.at(step.node);
    if (std::exchange(reached.is_settled, true)) continue;
    reached.place = step.distance * step.towards;
    for (std::int64_t arc = arcs.first(step.node); arc < arcs.first(step.node + 1); ++arc)
      search.push({step.distance + arcs.length(arc), arcs.target(arc), step.towards});
  }
}

}  // namespace saddleback
