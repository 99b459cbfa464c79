#include "tessellation/log_map/vertices_beside.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace saddleback {

VerticesBeside::VerticesBeside(CellLogMaps& maps)
    : maps_(maps), labels_(maps.labels()), arcs_(maps.graph().arcs()), placer_(maps), beside_(k_beside) {}

void VerticesBeside::forget() {
  site_ = k_none;
  ++age_;
}

void VerticesBeside::place_cell(Index site) {
  site_ = site;
  ++round_;
  answers_.clear();
  if (table_.empty()) table_.resize(labels_.node_count());  // by the thread that it is for
  const std::vector<Index>& nodes = maps_.seen().of(site).nodes;
  for (std::size_t i = 0; i < nodes.size(); ++i) table_[nodes[i]] = {round_, static_cast<Index>(i)};
  placer_.place(site);
}

/// Finds which of those that a site sees a node is; sooner for the site that was placed last.
Index VerticesBeside::find_seen(Index site, Index node) const {
  if (site_ != site) return maps_.seen().of(site).find(node);
  const Known known = table_[node];
  return known.round == round_ && known.at >= 0 ? known.at : k_none;
}

bool VerticesBeside::find(Index site, Index node, SiteVector& vector) {
  const SeenVertices& seen_vertices = maps_.seen().of(site);
  if (labels_.label(node) == site) {
    vector = maps_.own(node);
    return true;
  }
  if (node == seen_vertices.center) {  // two sites on one vertex
    vector = {};
    return true;
  }
  if (site_ == site) {
    const Known known = table_[node];
    if (known.round == round_ && known.at < 0) {
      vector = answers_[~known.at].vector;
      return answers_[~known.at].found;
    }
  }
  if (const Index seen = find_seen(site, node); seen != k_none) {
    const PackedVec2& place = seen_vertices.places[seen];
    vector = {place, place.norm()};
    if (!has_shorter_way(node, site, vector.distance)) return true;
  }
  VertexPlace place;
  const bool found = place_by_cell(node, site, place);
  if (found) vector = maps_.vector_of(place);
  if (site_ == site && table_[node].round != round_) {
    table_[node] = {round_, ~static_cast<Index>(answers_.size())};
    answers_.push_back({found, vector});
  }
  return found;
}

/// Tells whether a way over a node that the site owns or sees is shorter than the straight line to one that it sees:
/// the line may lead round the other side of a hole. Where the site owns neighbors of the node their ways decide, which
/// are few to ask; else those over all of its arcs.
bool VerticesBeside::has_shorter_way(Index node, Index site, double straight) const {
  const double least = straight * (1 - k_arc_rounding);
  bool owns_neighbor = false, is_shorter = false;
  const auto look = [&](Index other, const Vec2& edge) {
    if (labels_.label(other) != site) return;
    owns_neighbor = true;
    const double rest = least - maps_.place(other).distance;
    is_shorter = is_shorter || (rest > 0 && edge.squaredNorm() < rest * rest);
  };
  for (const VertexRings::Wedge& wedge : maps_.rings().around(node)) {
    look(wedge.from, wedge.apex);
    look(wedge.to, wedge.apex - Vec2(wedge.length, 0));
  }
  if (owns_neighbor) return is_shorter;
  for (std::int64_t arc = arcs_.first(node); arc < arcs_.first(node + 1); ++arc) {
    const Index other = arcs_.target(arc);
    const double rest = least - arcs_.length(arc);
    if (rest <= 0) continue;
    if (labels_.label(other) == site) {
      if (maps_.place(other).distance < rest) return true;
    } else if (const Index seen = find_seen(site, other);
               seen != k_none && maps_.seen().of(site).places[seen].squaredNorm() < rest * rest) {
      return true;
    }
  }
  return false;
}

/// Places a node next to vertices of the site's own cell, if it has any. A node across or beside an edge of theirs has
/// an arc to one of them: edges of the mesh are arcs. Corners of long faces may lie far outside the cell, and the ways
/// over its vertices lead there the long way round, or what lies between bends the surface unseen: where the way is not
/// as long as the place is away, the graph decides. What is seen across an edge is no nearer than it is seen, though
/// round a corner there be a shorter way: that is not how the site sees the faces beside its cell.
bool VerticesBeside::place_by_cell(Index node, Index site, VertexPlace& place) {
  if (labels_.nodes(site).empty()) return false;
  const bool is_seen = place_across_own(node, site, place) || place_across(node, site, true, place);
  const double straight = is_seen ? place.distance : std::numeric_limits<double>::infinity();
  const std::optional<double> way = place_by_arc(node, site, is_seen, place);
  if (!way) return false;
  place.distance = std::min(place.distance, straight);
  const double in_plane = maps_.anchor_distance(place) + place.at.norm();
  if (maps_.is_smooth() || std::abs(*way - in_plane) <= maps_.slack() * in_plane) return true;
  const double share = 1 - maps_.slack();  // of its length in the graph that a way may have where it is straight
  const double in_graph = shorter_way(node, site, share * *way).value_or(*way);
  place.distance = is_seen ? std::min(place.distance, std::max(in_graph, in_plane))
                           : std::clamp(place.distance, share * in_graph, in_graph);
  return true;
}

/// Finds the shortest way in the graph, over vertices of any label, if it is shorter than so much. It is looked for
/// from the node back to what the site owns or sees, where it is shortest at best first: no vertex is nearer to the
/// site than to that of its label, nor than the bird flies.
std::optional<double> VerticesBeside::shorter_way(Index node, Index site, double than) {
  const Mesh& mesh = maps_.graph().mesh();
  const SeenVertices& seen_vertices = maps_.seen().of(site);
  const Vec3 center = position(mesh, labels_.sites()[site]);
  const double share = 1 - maps_.slack();  // what is placed may be nearer than its label's distance in the graph
  double shortest = than;
  steps_.clear();
  reached_.clear();
  const auto push = [&](Index other, double back) {
    const double bird = mesh.bird((mesh.positions()[maps_.graph().vertex_of(other)] - center).norm());
    const Step step{back + std::max(bird, share * labels_.distance(other)), back, other};
    if (step.at_best >= shortest) return;
    const auto [known_back, is_new] = reached_.try_emplace(other, back);
    if (!is_new && known_back->second <= back) return;
    known_back->second = back;
    steps_.push_back(step);
    std::ranges::push_heap(steps_, std::greater<>());
  };
  push(node, 0);
  while (!steps_.empty() && steps_.front().at_best < shortest) {
    std::ranges::pop_heap(steps_, std::greater<>());
    const Step step = steps_.back();
    steps_.pop_back();
    if (step.back > reached_.at(step.node)) continue;
    if (labels_.label(step.node) == site || step.node == seen_vertices.center) {
      const double rest = step.node == seen_vertices.center ? 0 : maps_.place(step.node).distance;
      shortest = std::min(shortest, step.back + rest);
      continue;
    }
    if (const Index seen = find_seen(site, step.node); seen != k_none)
      shortest = std::min(shortest, step.back + seen_vertices.places[seen].norm());
    for (std::int64_t arc = arcs_.first(step.node); arc < arcs_.first(step.node + 1); ++arc)
      push(arcs_.target(arc), step.back + arcs_.length(arc));
  }
  return shortest < than ? std::optional(shortest) : std::nullopt;
}

/// Tells where the site sees an end of an edge: a node of its cell or, where `deep`, any that can be placed beside its
/// own. Null where there is none.
const VertexPlace* VerticesBeside::end_of_edge(Index node, Index site, bool deep, VertexPlace& place) {
  if (labels_.label(node) == site) return &maps_.place(node);
  return deep && place_across_own(node, site, place) ? &place : nullptr;
}

/// Places a node beyond edges of the site's own cell; remembered.
bool VerticesBeside::place_across_own(Index node, Index site, VertexPlace& place) {
  Beside& entry = beside_[slot_of(site, node) % k_beside];
  if (entry.age != age_ || entry.node != node || entry.site != site) {
    entry.age = age_;
    entry.node = node;
    entry.site = site;
    entry.found = place_across(node, site, false, entry.place);
  }
  place = entry.place;
  return entry.found;
}

/// Places a node beyond the edge across which the site is seen best: between the edge's ends if there is one, else
/// least beside them; among equals the shortest way, of several the first.
bool VerticesBeside::place_across(Index node, Index site, bool deep, VertexPlace& place) {
  EdgeSight best;
  const VertexRings::Wedge* best_wedge = nullptr;
  VertexPlace best_from, best_to;
  for (const VertexRings::Wedge& wedge : maps_.rings().around(node)) {
    const bool owns_from = labels_.label(wedge.from) == site, owns_to = labels_.label(wedge.to) == site;
    if (deep ? !owns_from && !owns_to : !owns_from || !owns_to) continue;
    VertexPlace from_memory, to_memory;
    const VertexPlace* const from = end_of_edge(wedge.from, site, deep, from_memory);
    const VertexPlace* const to = from ? end_of_edge(wedge.to, site, deep, to_memory) : nullptr;
    EdgeSight found;
    if (!to || !see(wedge, *from, *to, found)) continue;
    const double nearer = std::abs(best.beyond) - std::abs(found.beyond);
    const bool better =
        !best_wedge || nearer > k_hit || (nearer >= -k_hit && found.distance < best.distance * (1 - k_arc_rounding));
    if (better) best = found, best_wedge = &wedge, best_from = *from, best_to = *to;
  }
  if (!best_wedge) return false;
  const double to_anchor = maps_.anchor_distance(best_from);
  best.is_flat = best.is_flat && is_straight(best_from.at, best_from.distance - to_anchor) &&
                 is_straight(best_to.at, best_to.distance - to_anchor);
  place = placer_.place_beyond(best, *best_wedge, best_from, best_to);
  return true;
}

/// Gives a place the length of the shortest way over a graph neighbor that the site owns or, where it owns hardly one,
/// sees, and, unless it has one, the direction of that way. Returns the way's length though the place lies flat, and is
/// nearer; none where there is no way.
std::optional<double> VerticesBeside::place_by_arc(Index node, Index site, bool has_direction, VertexPlace& place) {
  constexpr int k_enough = 2;
  double shortest = std::numeric_limits<double>::infinity();
  Index before = k_none, seen_before = k_none;
  int count = 0;
  for (std::int64_t arc = arcs_.first(node); arc < arcs_.first(node + 1); ++arc) {
    const Index other = arcs_.target(arc);
    if (labels_.label(other) != site) continue;
    ++count;
    const double distance = maps_.place(other).distance + arcs_.length(arc);
    if (distance < shortest) shortest = distance, before = other;
  }
  for (std::int64_t arc = arcs_.first(node); count < k_enough && arc < arcs_.first(node + 1); ++arc) {
    const Index seen = find_seen(site, arcs_.target(arc));
    if (seen == k_none) continue;
    const double distance = maps_.seen().of(site).places[seen].norm() + arcs_.length(arc);
    if (distance < shortest) shortest = distance, seen_before = seen;
  }
  if (shortest == std::numeric_limits<double>::infinity()) return {};
  if (!has_direction)
    place = before != k_none ? placer_.place_after(node, before) : place_after_seen(node, site, seen_before);
  place.distance = shortest;
  if (lies_flat(node, site, place, count < k_enough)) place.distance = maps_.anchor_distance(place) + place.at.norm();
  return shortest;
}

/// Places a node where a way over another that the site sees leads, straight from the site unless it bends there for
/// good.
VertexPlace VerticesBeside::place_after_seen(Index node, Index site, Index seen) {
  const Index before = maps_.seen().of(site).nodes[seen];
  const VertexPlace at_seen = VertexPlace::straight(maps_.seen().of(site).places[seen]);
  VertexPlace place = placer_.place_after(node, before, at_seen, maps_.seen().direction_back(site, seen));
  if (place.anchor != before) return place;
  return {at_seen.at, place.distance, k_none, VertexPlace::k_after_another};
}

/// Tells whether the arcs from all of the site's nodes, and, where wanted, from those that it sees, end where the node
/// was placed: then nothing there bends the surface.
bool VerticesBeside::lies_flat(Index node, Index site, const VertexPlace& place, bool with_seen) const {
  int count = 0;
  for (std::int64_t arc = arcs_.first(node); arc < arcs_.first(node + 1); ++arc) {
    const Index other = arcs_.target(arc);
    Vec2 at;
    if (labels_.label(other) == site) {
      at = maps_.place(other).at;
      if (maps_.place(other).anchor != place.anchor) return false;
      if (!is_straight(at, maps_.place(other).distance - maps_.anchor_distance(place))) return false;
    } else {
      const Index seen = with_seen && place.anchor == k_none ? find_seen(site, other) : k_none;
      if (seen == k_none) continue;
      at = maps_.seen().of(site).places[seen];
    }
    const double length = arcs_.length(arc);
    if (std::abs((place.at - at).norm() - length) > k_arc_rounding * length) return false;
    ++count;
  }
  return count > 1;
}

}  // namespace saddleback
