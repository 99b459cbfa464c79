#include "tessellation/log_map/cell_placer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tessellation/log_map/interpolated_direction.h"

namespace saddleback {
namespace {

// An edge's end that a ray passes by less than this share of the edge's length it may as well hit.
constexpr double k_least_miss = 1e-3;

// Radians: a path that turns less goes straight on, but for rounding.
constexpr double k_least_turn = 1e-9;

// How many nodes ahead what lies around a node is fetched from memory: by distance they follow in no order of memory.
// The first of a cell are fetched while the cell before is placed.
constexpr int k_ahead = 8;

/// The angle by which a path that comes from direction `back` and goes on in direction `out` turns (left positive) when
/// developed.
double turn_at(const Mesh& mesh, Index vertex, double back, double out) {
  if (mesh.is_boundary(vertex)) {  // only one side of the path is surface
    return out >= back ? std::min(out - back - std::numbers::pi, 0.0) : std::max(std::numbers::pi - (back - out), 0.0);
  }
  const double total = mesh.total_angle(vertex);
  double left_side = out - back;  // counter-clockwise from back to out
  if (left_side < 0) left_side += total;
  if (left_side >= total) left_side -= total;
  if (total <= 2 * std::numbers::pi) return left_side - total / 2;
  if (left_side < std::numbers::pi) return left_side - std::numbers::pi;
  if (total - left_side < std::numbers::pi) return std::numbers::pi - (total - left_side);
  return 0;
}

/// Tells whether a path may bend where it comes from `back` and goes on towards `out`, so much that it counts. One that
/// goes on straight may, too.
bool is_anchor(const Mesh& mesh, Index vertex, double back, double out) {
  return VertexRings::bends_much(mesh, vertex) && std::abs(turn_at(mesh, vertex, back, out)) <= k_least_turn;
}

/// Places a node which the way to it reaches from somewhere nearer by less than rounding tells.
VertexPlace end_of_way(double distance) { return {Vec2(distance, 0), distance, k_none, VertexPlace::k_end_of_way}; }

}  // namespace

CellPlacer::CellPlacer(CellLogMaps& maps)
    : maps_(maps),
      graph_(maps.graph()),
      mesh_(maps.graph().mesh()),
      rings_(maps.rings()),
      labels_(maps.labels()),
      unfolder_(maps.graph().unfolding()) {}

void CellPlacer::fetch(Index site) const {
  const auto own = labels_.nodes(site);
  for (const Index node : own.first(std::min<std::size_t>(own.size(), k_ahead))) {
    maps_.fetch(node);
    rings_.fetch(node);
  }
  maps_.seen().fetch(site);
}

void CellPlacer::place(Index site) {
  const std::span<const Index> nodes = maps_.sort_nodes(site);
  for (const Index node : nodes) maps_.mark_unplaced(node);
  place_straight(site);
  for (auto node = nodes.begin(); node != nodes.end(); ++node) {
    if (nodes.end() - node > k_ahead) rings_.fetch(node[k_ahead]);
    if (maps_.is_placed(*node)) continue;
    const double distance = labels_.distance(*node);
    VertexPlace place;
    if (!place_across(*node, site, place)) {
      const Index previous = node_before(*node, site);
      place = previous != k_none ? place_after(*node, previous) : end_of_way(distance);
    }
    // Beside short edges what an arc is when it is laid out may be longer than the arc.
    if (place.distance > distance * (1 + k_arc_rounding)) place.distance = distance;
    maps_.set_place(*node, place);
  }
}

/// Places what the site sees: each may serve as the end of an edge that others are seen across. A line that grazes a
/// vertex is as long as the path over it, and is the better: what is seen behind changes where that vertex is an
/// anchor.
void CellPlacer::place_straight(Index site) {
  const SeenVertices& seen = maps_.seen().of(site);
  for (std::size_t i = 0; i < seen.nodes.size(); ++i) {
    const Index node = seen.nodes[i];
    const double distance = labels_.distance(node);
    if (labels_.label(node) != site || seen.rounded[i] > distance * (1 + k_arc_rounding)) continue;
    const bool is_known = i < seen.arc_count || maps_.is_smooth();
    std::optional<Vec2> place = is_known ? seen.places[i] : seen_truly(site, node, seen.places[i]);
    if (!place) continue;
    // Beside short edges an arc, or what the waves told in single precision, may be longer when it is laid out.
    if (!maps_.is_smooth() && place->norm() > distance * (1 + k_arc_rounding)) *place *= distance / place->norm();
    maps_.set_place(node, VertexPlace::straight(*place));
  }
  if (seen.center != k_none && labels_.label(seen.center) == site)
    maps_.set_place(seen.center, {.found_by = VertexPlace::k_center});
}

/// Tells where a node lies that the waves see, in single precision, past another vertex: beside short edges what is a
/// little hidden is nearer by more than rounding. None where the straight line leads elsewhere.
std::optional<Vec2> CellPlacer::seen_truly(Index site, Index node, const Vec2& place) const {
  const Index face = labels_.sites()[site].face;
  const FaceChart chart(mesh_, face);
  const Vec2 center = chart.to_plane(labels_.sites()[site].barycentric);
  for (int i = 0; i < 3; ++i) {
    const Vec2 from = chart.corner[i], along = (chart.corner[(i + 1) % 3] - from).normalized();
    const Vec2 right = from - center, left = chart.corner[(i + 1) % 3] - center;
    if (cross(right, place) < 0 || cross(place, left) < 0) continue;
    const auto in_frame = [&](const Vec2& at) { return Vec2(along.dot(at - from), cross(along, at - from)); };
    const LegEnd end = leg_end(mesh_, graph_.vertex_of(node));
    const std::optional<double> length =
        line_across(graph_.unfolding(), 3 * face + i, in_frame(center), in_frame(center + place), end);
    if (length) return Vec2(place * (*length / place.norm()));
  }
  return {};
}

/// Finds the last of a site's nodes on a path to the node that is as short as the shortest, but for the roundings of
/// arcs; of several the one with the longest arc, of those the first.
Index CellPlacer::node_before(Index node, Index site) const {
  const ArcRows& arcs = graph_.arcs();
  const double shortest = labels_.distance(node), most = shortest * (1 + k_arc_rounding);
  Index before = k_none;
  double longest = 0;
  for (std::int64_t arc = arcs.first(node); arc < arcs.first(node + 1); ++arc) {
    const Index other = arcs.target(arc);
    if (labels_.label(other) != site || labels_.distance(other) >= shortest) continue;
    const double length = arcs.length(arc);
    if (labels_.distance(other) + length > most || length <= longest * (1 + k_arc_rounding)) continue;
    longest = length;
    before = other;
  }
  return before;
}

VertexPlace CellPlacer::place_after(Index node, Index previous) {
  return place_after(node, previous, maps_.place(previous), direction_back(previous));
}

VertexPlace CellPlacer::place_after(Index node, Index previous, const VertexPlace& before, double back) {
  const Index vertex = graph_.vertex_of(previous);
  const std::int64_t arc = graph_.arcs().find(previous, node);
  const bool unfolds = unfolder_.unfold(graph_.hint(previous, arc), unfolded_);
  const double length = unfolds ? unfolded_.length : graph_.arcs().length(arc);
  const double out = unfolded_.start_angle;
  const double distance = before.distance + length;
  const bool is_center = before.found_by == VertexPlace::k_center;  // whose place is in no direction
  if (!is_center && is_anchor(mesh_, vertex, back, out))
    return {polar(length, out - back), distance, previous, VertexPlace::k_after_another};
  const double heading = std::atan2(before.at.y(), before.at.x()) + turn_at(mesh_, vertex, back, out);
  return {before.at + polar(length, heading), distance, before.anchor, VertexPlace::k_after_another};
}

/// Tells the surface angle at a placed node towards its anchor. Few are asked for it.
double CellPlacer::direction_back(Index node) {
  const VertexPlace& place = maps_.place(node);
  if (place.found_by == VertexPlace::k_center || place.found_by == VertexPlace::k_end_of_way) return 0;
  if (place.found_by == VertexPlace::k_straight) {
    const Index site = labels_.label(node);
    return maps_.seen().direction_back(site, maps_.seen().of(site).find(node));
  }
  if (place.found_by == VertexPlace::k_after_another) {
    const Index previous = node_before(node, labels_.label(node));
    unfolder_.unfold(graph_.hint(previous, graph_.arcs().find(previous, node)), unfolded_);
    const double back = unfolded_.end_angle;
    return place.anchor == previous ? back : back + angle_between(place.at - maps_.place(previous).at, place.at);
  }
  const VertexRings::Wedge& wedge = rings_.wedge(place.found_by);
  EdgeSight sight;
  see(wedge, maps_.place(wedge.from), maps_.place(wedge.to), sight);
  return graph_.unfolding().polar(Mesh::prev(rings_.halfedge(wedge.side))) +
         angle_between(Vec2(-wedge.apex), Vec2(-sight.ray));
}

VertexPlace CellPlacer::place_beyond(const EdgeSight& sight, const VertexRings::Wedge& wedge, const VertexPlace& from,
                                     const VertexPlace& to) const {
  const Vec2 to_start = -sight.anchor, to_end = Vec2(wedge.length, 0) - sight.anchor;
  VertexPlace place{seen_between(from.at, to.at, to_start, to_end, sight.ray), std::numeric_limits<double>::infinity(),
                    from.anchor, rings_.index(wedge)};
  if (sight.is_flat) place.distance = sight.distance + maps_.anchor_distance(place);
  return place;
}

/// Places a node of the site's own cell beyond an edge whose ends are placed already: the first that leads to the
/// graph's distance or little less, else the one that leads to the least more, at the graph's distance. False where
/// there is none.
bool CellPlacer::place_across(Index node, Index site, VertexPlace& place) const {
  const double in_graph = labels_.distance(node), slack = maps_.slack();
  const double most = in_graph * (1 + k_arc_rounding), least = (1 - slack) * most;
  double shortest = (1 + slack) * most;
  const VertexRings::Wedge* detour = nullptr;
  for (const VertexRings::Wedge& wedge : rings_.around(node)) {
    if (labels_.label(wedge.from) != site || labels_.label(wedge.to) != site) continue;
    const VertexPlace &from = maps_.place(wedge.from), &to = maps_.place(wedge.to);
    if (from.found_by == VertexPlace::k_unplaced || to.found_by == VertexPlace::k_unplaced) continue;
    EdgeSight sight;
    if (!see(wedge, from, to, sight) || std::abs(sight.beyond) > k_least_miss) continue;
    const double to_anchor = maps_.anchor_distance(from);
    if (to_anchor >= in_graph) continue;
    sight.is_flat =
        sight.is_flat && is_straight(from.at, from.distance - to_anchor) && is_straight(to.at, to.distance - to_anchor);
    const double distance = maps_.anchor_distance(from) + sight.distance;
    if (distance < least || distance >= shortest * (1 - k_arc_rounding)) continue;
    place = place_beyond(sight, wedge, from, to);
    if (distance <= most) {
      const std::optional<double> straight =
          sight.is_flat ? line_to_anchor(wedge, sight, place.anchor, site) : std::nullopt;
      if (straight) place.at *= *straight / place.at.norm();
      place.distance = straight ? std::min(to_anchor + *straight, in_graph) : in_graph;
      return true;
    }
    shortest = distance;
    detour = &wedge;
  }
  if (!detour) return false;
  const double straight = in_graph - maps_.anchor_distance(place);
  place.at *= straight / place.at.norm();
  place.distance = in_graph;
  return true;
}

/// Ways on both sides of a hole, or of a bump, fit a plane as well as those around nothing do: what tells is the line.
std::optional<double> CellPlacer::line_to_anchor(const VertexRings::Wedge& wedge, const EdgeSight& sight, Index anchor,
                                                 Index site) const {
  if (maps_.is_flat_disk()) return sight.distance;
  const Index node = anchor != k_none ? anchor : maps_.seen().of(site).center;
  const LegEnd end = node != k_none ? leg_end(mesh_, graph_.vertex_of(node)) : leg_end(mesh_, labels_.sites()[site]);
  return line_across(graph_.unfolding(), rings_.halfedge(wedge.side), wedge.apex, sight.anchor, end);
}

}  // namespace saddleback
