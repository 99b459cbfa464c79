#include "tessellation/cells/extrapolated_corners.h"

#include <cmath>
#include <limits>
#include <utility>

#include "support/planar.h"

namespace saddleback {
namespace {

std::uint64_t pair_key(Index site, Index other) {
  return static_cast<std::uint64_t>(site) << 32 | static_cast<std::uint32_t>(other);
}

}  // namespace

const PackedVec2* ExtrapolatedCorners::find(Index site, Index node) const {
  const auto found = corners_.find(pair_key(site, node));
  return found != corners_.end() ? &found->second : nullptr;
}

void ExtrapolatedCorners::complete(CellCandidate& candidate, Index side) {
  constexpr double k_bent = 3e-2;  // how much ways may differ from what is seen where lengths are smooth
  const VertexRings& rings = maps_.rings();
  const auto& nodes = rings.face(candidate.face).nodes;
  const auto lay = [&](int corner, const std::optional<PackedVec2>& seen) {
    if (!std::isnan(candidate.corner[corner].x())) return;
    const Index node = nodes[corner];
    PackedVec2 place = seen && !maps_.is_smooth() ? *seen : along_arcs(candidate.site, node);
    if (seen && std::abs(seen->norm() - place.norm()) <= k_bent * place.norm()) place = *seen;
    candidate.corner[corner] = corners_.try_emplace(pair_key(candidate.site, node), place).first->second;
  };
  const int apex = side == k_none ? 2 : Mesh::prev(side) % 3, start = Mesh::next(apex), end = Mesh::prev(apex);
  lay(start, {});
  lay(end, {});
  lay(apex, side == k_none ? std::nullopt
                           : seen_beyond(rings.halfedge(side), candidate.corner[start], candidate.corner[end]));
}

/// Lays the third corner of a half-edge's face in the plane, beyond an edge whose ends are known, if it is seen there
/// in truth: the site and the ends make a flat triangle, and the way to the corner crosses the edge. Where lengths are
/// smooth, wherever the ends are.
std::optional<PackedVec2> ExtrapolatedCorners::seen_beyond(Index halfedge, const PackedVec2& from,
                                                           const PackedVec2& to) const {
  const Unfolding& unfolding = maps_.graph().unfolding();
  if (!maps_.is_smooth() && !fits(from, to, unfolding.mesh().length(halfedge))) return {};
  const Vec2 along = (to - from).normalized();
  const Vec2& apex = unfolding.apex(halfedge);
  const Vec2 place = from + apex.x() * along + apex.y() * Vec2(-along.y(), along.x());
  const bool crosses = cross(Vec2(to), Vec2(from)) > 0 && cross(Vec2(to), place) >= 0 && cross(place, Vec2(from)) >= 0;
  return crosses || maps_.is_smooth() ? std::optional<PackedVec2>(place) : std::nullopt;
}

/// Begins a search with what a site sees straight: no longer than it is, and nothing that is hidden.
ExtrapolatedCorners::Search ExtrapolatedCorners::begin(Index site) {
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
void ExtrapolatedCorners::Search::push(const Step& step) {
  double& known = reached[step.node].distance;
  if (known <= step.distance) return;
  known = step.distance;
  queue.push(step);
}

/// Follows the shortest way in the graph, as if it went on as it begins.
PackedVec2 ExtrapolatedCorners::along_arcs(Index site, Index node) {
  auto entry = searches_.find(site);
  if (entry == searches_.end()) entry = searches_.emplace(site, begin(site)).first;
  Search& search = entry->second;
  const ArcRows& arcs = maps_.graph().arcs();
  for (std::size_t steps = 0;; ++steps) {
    if (const auto found = search.reached.find(node); found != search.reached.end() && found->second.is_settled)
      return found->second.place;
    if (steps % 64 == 0) stage_.check();
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
