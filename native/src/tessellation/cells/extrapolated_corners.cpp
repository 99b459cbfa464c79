#include "tessellation/cells/extrapolated_corners.h"

#include <cmath>
#include <limits>

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
    stage_.check();
    PackedVec2 place = seen && !maps_.is_smooth() ? *seen : ways_.find(candidate.site, node);
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

}  // namespace saddleback
