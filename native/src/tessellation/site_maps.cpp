// Method: labels by shortest paths in the graph; then each cell's vertices are placed in order of their distance. A
// vertex next to another site's cell is placed from vertices of that cell alone: the last bit of the path leaves the
// cell, all before lies inside (cells are star-shaped).

#include "tessellation/site_maps.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "geodesics/direct_fans.h"
#include "geodesics/query_cache.h"
#include "support/parallel.h"

namespace saddleback {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();

// Straight lines are shorter than paths in a graph by its error; more than this is no straight line on the surface.
constexpr double k_least_slack = 1e-2;

// Of arcs, see ArcCodec.
constexpr double k_arc_rounding = 2e-9;

// An edge's end that a ray passes by less than this share of the edge's length it may as well hit.
constexpr double k_least_miss = 1e-3;

// Square of the least angle at which an edge must be seen: what lies beyond one seen end-on cannot be told from it.
constexpr double k_end_on = 1e-10;

Vec2 polar(double length, double angle) { return {length * std::cos(angle), length * std::sin(angle)}; }

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

double angle_between(const Vec2& a, const Vec2& b) { return std::atan2(cross(a, b), a.dot(b)); }

/// By how much a path that comes from direction `back` and goes on in direction `out` turns (left positive) when
/// developed.
double turn_at(const Mesh& mesh, Index vertex, double back, double out) {
  if (mesh.is_boundary(vertex)) {  // only one side of the path is surface
    return out >= back ? std::min(out - back - M_PI, 0.0) : std::max(M_PI - (back - out), 0.0);
  }
  const double total = mesh.total_angle(vertex);
  double left_side = out - back;  // counter-clockwise from back to out
  if (left_side < 0) left_side += total;
  if (left_side >= total) left_side -= total;
  if (total <= 2 * M_PI) return left_side - total / 2;
  if (left_side < M_PI) return left_side - M_PI;
  if (total - left_side < M_PI) return M_PI - (total - left_side);
  return 0;
}

void sort_by_node(std::vector<DirectArc>& arcs) {
  std::sort(arcs.begin(), arcs.end(), [](const DirectArc& a, const DirectArc& b) { return a.vertex < b.vertex; });
}

}  // namespace

SiteMaps::SiteMaps(const SaddleVertexGraph& graph, const VertexRings& rings, const SurfacePoints& sites,
                   std::span<const double> reaches, int threads, const JobStage& stage)
    : graph_(graph),
      mesh_(graph.mesh()),
      rings_(rings),
      sites_(sites),
      slack_(std::max(2 * graph.accuracy(), k_least_slack)),
      fans_(sites.size()),
      places_(graph.mesh().vertex_count()),
      placed_(graph.mesh().vertex_count(), 0) {
  make_fans(reaches, threads, stage.part(0, 0.3));
  label_nodes(stage);
  group_nodes();
  stage.update(0.8);
  std::vector<std::unique_ptr<Scratch>> scratch(thread_count(threads));
  const std::vector<Index> order = sites_along_curve();
  parallel_for(site_count(), threads, 16, [&](Index i, int thread) {
    stage.check();
    if (!scratch[thread]) scratch[thread] = std::make_unique<Scratch>(*this);
    place_cell(order[i], *scratch[thread]);
  });
  stage.update(1);
}

void SiteMaps::make_fans(std::span<const double> reaches, int threads, const JobStage& stage) {
  for_each_fan(graph_, sites_, reaches, FanAngles::both, threads, stage,
               [&](Index site, std::span<const DirectArc> arcs) {
                 Fan& fan = fans_[site];
                 fan.arcs.assign(arcs.begin(), arcs.end());
                 for (DirectArc& arc : fan.arcs) {
                   arc.vertex = graph_.node_of(arc.vertex);
                   arc.length = graph_.arcs().codec().round(arc.length);
                 }
                 sort_by_node(fan.arcs);
               });
  std::vector<Index> at_vertices;
  for (Index site = 0; site < site_count(); ++site) {
    const Index vertex = vertex_at(mesh_, sites_[site]);
    if (vertex == k_none) continue;
    fans_[site].centre = graph_.node_of(vertex);
    at_vertices.push_back(site);
  }
  parallel_for(static_cast<Index>(at_vertices.size()), threads, 16, [&](Index i, int) {
    stage.check();
    make_fan_at_vertex(fans_[at_vertices[i]]);
  });
}

void SiteMaps::make_fan_at_vertex(Fan& fan) {
  const Index node = fan.centre, vertex = graph_.vertex_of(node);
  const double scale = mesh_.is_boundary(vertex) ? 1 : 2 * M_PI / mesh_.total_angle(vertex);
  const ArcRows& arcs = graph_.arcs();
  ArcUnfolder unfolder(graph_.unfolding());
  UnfoldedArc unfolded;
  for (std::int64_t arc = arcs.first(node); arc < arcs.first(node + 1); ++arc) {
    unfolder.unfold(graph_.hint(node, arc), unfolded);
    fan.arcs.push_back({arcs.target(arc), arcs.length(arc), scale * unfolded.start_angle, unfolded.end_angle});
  }
  sort_by_node(fan.arcs);
}

void SiteMaps::label_nodes(const JobStage& stage) {
  std::vector<Seed> seeds;
  for (Index site = 0; site < site_count(); ++site) {
    const Fan& fan = fans_[site];
    if (fan.centre != k_none) seeds.push_back({graph_.vertex_of(fan.centre), site, 0});
    for (const DirectArc& arc : fan.arcs) seeds.push_back({graph_.vertex_of(arc.vertex), site, arc.length});
  }
  const auto search = graph_.query_cache().field_searches.lease();
  search->run(graph_, seeds, {}, SearchLabels::sources, stage.part(0.3, 0.8));
  label_.assign(search->node_sources().begin(), search->node_sources().end());
  distance_.assign(search->node_distances().begin(), search->node_distances().end());
}

void SiteMaps::group_nodes() {
  first_node_.assign(site_count() + 1, 0);
  for (const Index site : label_) ++first_node_[site + 1];
  for (Index site = 0; site < site_count(); ++site) first_node_[site + 1] += first_node_[site];
  nodes_.resize(label_.size());
  std::vector<Index> cursor(first_node_.begin(), first_node_.end() - 1);
  for (Index node = 0; node < mesh_.vertex_count(); ++node) nodes_[cursor[label_[node]]++] = node;
}

Index SiteMaps::farthest_vertex(Index site) const {
  const Index last = first_node_[site + 1];
  return last == first_node_[site] ? k_none : graph_.vertex_of(nodes_[last - 1]);
}

/// Cells beside each other one after the other: they use the same memory.
std::vector<Index> SiteMaps::sites_along_curve() const {
  std::vector<std::pair<Index, Index>> order;
  for (Index site = 0; site < site_count(); ++site) {
    order.emplace_back(graph_.node_of(mesh_.triangles()[sites_[site].face][0]), site);
  }
  std::sort(order.begin(), order.end());
  std::vector<Index> sites;
  for (const auto& [node, site] : order) sites.push_back(site);
  return sites;
}

void SiteMaps::place_cell(Index site, Scratch& scratch) {
  const auto first = nodes_.begin() + first_node_[site], last = nodes_.begin() + first_node_[site + 1];
  std::sort(first, last,
            [&](Index a, Index b) { return distance_[a] != distance_[b] ? distance_[a] < distance_[b] : a < b; });
  const Fan& fan = fans_[site];
  // Straight ones first: each may serve as the end of an edge that others are seen across.
  for (const DirectArc& arc : fan.arcs) {
    if (label_[arc.vertex] != site || arc.length > distance_[arc.vertex]) continue;
    places_[arc.vertex] = place_direct(arc);
    placed_[arc.vertex] = 1;
  }
  if (fan.centre != k_none && label_[fan.centre] == site) placed_[fan.centre] = 1;
  for (auto node = first; node != last; ++node) {
    if (placed_[*node]) continue;
    if (!place_own(*node, site, places_[*node])) places_[*node] = place_after(*node, node_before(*node), scratch);
    placed_[*node] = 1;
  }
}

const DirectArc* SiteMaps::fan_arc(Index site, Index node) const {
  const auto& arcs = fans_[site].arcs;
  const auto found = std::lower_bound(arcs.begin(), arcs.end(), node,
                                      [](const DirectArc& arc, Index wanted) { return arc.vertex < wanted; });
  return found != arcs.end() && found->vertex == node ? &*found : nullptr;
}

SiteMaps::Place SiteMaps::place_direct(const DirectArc& arc) const {
  return {polar(arc.length, arc.start_angle), arc.length, arc.end_angle, k_none};
}

/// Whether a path may bend where it comes from `back` and goes on towards `out`, so much that it counts.
bool SiteMaps::is_anchor(Index vertex, double back, double out) const {
  return VertexRings::bends_much(mesh_, vertex) && turn_at(mesh_, vertex, back, out) == 0;
}

/// On a shortest path in the graph, by the sums of arcs, which are exact; of several the one with the longest arc.
Index SiteMaps::node_before(Index node) const {
  const ArcRows& arcs = graph_.arcs();
  Index before = k_none;
  double longest = 0;
  for (std::int64_t arc = arcs.first(node); arc < arcs.first(node + 1); ++arc) {
    const Index other = arcs.target(arc);
    const double length = arcs.length(arc);
    if (distance_[other] + length != distance_[node] || label_[other] != label_[node] || length <= longest) continue;
    longest = length;
    before = other;
  }
  return before;
}

SiteMaps::Place SiteMaps::place_after(Index node, Index previous, Scratch& scratch) const {
  const Place& before = places_[previous];
  const Index vertex = graph_.vertex_of(previous);
  const std::int64_t arc = graph_.arcs().find(previous, node);
  scratch.unfolder.unfold(graph_.hint(previous, arc), scratch.unfolded);
  const double length = graph_.arcs().length(arc), out = scratch.unfolded.start_angle;
  if (is_anchor(vertex, before.back, out)) {
    return {polar(length, out - before.back), before.distance + length, scratch.unfolded.end_angle, previous};
  }
  const double heading = std::atan2(before.at.y(), before.at.x()) + turn_at(mesh_, vertex, before.back, out);
  const Vec2 step = polar(length, heading), at = before.at + step;
  return {at, anchor_distance(before) + at.norm(), scratch.unfolded.end_angle + angle_between(step, at), before.anchor};
}

/// False where the anchor is on the corner's own side of the edge, where the lengths make no triangle, or where the ray
/// passes an end that is not nearly flat.
bool SiteMaps::see(const Wedge& wedge, const Place& from, const Place& to, Sight& sight) {
  if (from.anchor != to.anchor || cross(from.at, to.at) >= 0) return false;
  const double length = wedge.length, a = from.at.squaredNorm(), b = to.at.squaredNorm();
  // The edge runs along the x axis, the corner above, the anchor below.
  const double x = (a - b + length * length) / (2 * length), y = a - x * x;
  if (!(y > k_end_on * length * length)) return false;
  sight.anchor = Vec2(x, -std::sqrt(y));
  sight.ray = wedge.apex - sight.anchor;
  const double at_edge = x - sight.ray.x() * sight.anchor.y() / sight.ray.y();
  sight.beyond = at_edge < 0 ? at_edge / length : std::max(0.0, at_edge / length - 1);
  sight.distance = sight.ray.norm();
  return sight.beyond == 0 || !(sight.beyond < 0 ? wedge.from_bends : wedge.to_bends);
}

/// The direction divides the angle between those of the edge's ends as the ray divides it in the edge's frame.
SiteMaps::Place SiteMaps::place_by(const Sight& sight, const Wedge& wedge, const Place& from, const Place& to) const {
  const Vec2 to_start = -sight.anchor, to_end = Vec2(wedge.length, 0) - sight.anchor;
  const double share = angle_between(to_start, sight.ray) / angle_between(to_start, to_end);
  const double angle = std::atan2(from.at.y(), from.at.x()) + share * angle_between(from.at, to.at);
  Place place{polar(sight.distance, angle), sight.distance, 0, from.anchor};
  place.distance += anchor_distance(place);
  const double to_edge = graph_.unfolding().polar(Mesh::prev(wedge.halfedge));
  place.back = to_edge + angle_between(Vec2(-wedge.apex), Vec2(-sight.ray));
  return place;
}

/// Places a node of the site's own cell beyond an edge whose ends are placed already: the first that leads to the
/// graph's distance or little less. False where there is none.
bool SiteMaps::place_own(Index node, Index site, Place& place) const {
  const double most = distance_[node] * (1 + k_arc_rounding), least = (1 - slack_) * most;
  for (const Wedge& wedge : rings_.around(node)) {
    if (label_[wedge.from] != site || label_[wedge.to] != site || !placed_[wedge.from] || !placed_[wedge.to]) continue;
    const Place &from = places_[wedge.from], &to = places_[wedge.to];
    Sight sight;
    if (!see(wedge, from, to, sight) || std::abs(sight.beyond) > k_least_miss) continue;
    const double distance = anchor_distance(from) + sight.distance;
    if (distance > most || distance < least) continue;
    place = place_by(sight, wedge, from, to);
    return true;
  }
  return false;
}

/// An end of an edge as the site sees it; the site's own or, where `deep`, any that can be placed beside its own.
bool SiteMaps::end_of_edge(Index node, Index site, Scratch* deep, Place& place) const {
  if (label_[node] != site) return deep && beside_own(node, site, *deep, place);
  place = places_[node];
  return true;
}

/// Beyond edges of the site's own cell; remembered.
bool SiteMaps::beside_own(Index node, Index site, Scratch& scratch, Place& place) const {
  Scratch::Beside& entry = scratch.beside[static_cast<std::size_t>(node) % Scratch::k_beside];
  if (entry.node != node || entry.site != site) {
    entry.node = node;
    entry.site = site;
    entry.found = place_beside(node, site, nullptr, entry.place);
  }
  place = entry.place;
  return entry.found;
}

/// Places a node beyond the edge across which the site is seen best: between the edge's ends if there is one, else
/// least beside them; among equals the shortest way.
bool SiteMaps::place_beside(Index node, Index site, Scratch* deep, Place& place) const {
  Sight best;
  const Wedge* best_wedge = nullptr;
  Place best_from, best_to;
  for (const Wedge& wedge : rings_.around(node)) {
    const bool owns_from = label_[wedge.from] == site, owns_to = label_[wedge.to] == site;
    if (deep ? !owns_from && !owns_to : !owns_from || !owns_to) continue;
    Place from, to;
    Sight found;
    if (!end_of_edge(wedge.from, site, deep, from) || !end_of_edge(wedge.to, site, deep, to)) continue;
    if (!see(wedge, from, to, found)) continue;
    const double beyond = std::abs(found.beyond), best_beyond = std::abs(best.beyond);
    const bool better =
        !best_wedge || beyond < best_beyond || (beyond == best_beyond && found.distance < best.distance);
    if (better) best = found, best_wedge = &wedge, best_from = from, best_to = to;
  }
  if (!best_wedge) return false;
  place = place_by(best, *best_wedge, best_from, best_to);
  return true;
}

/// What lies behind an anchor is seen in its direction.
SiteVector SiteMaps::vector_of(const Place& place) const {
  if (place.anchor == k_none) return {place.at, place.distance};
  return {place.distance * vector_of(places_[place.anchor]).log.normalized(), place.distance};
}

bool SiteMaps::find(Index site, Index vertex, Scratch& scratch, SiteVector& vector) const {
  const Index node = graph_.node_of(vertex);
  Place place;
  if (label_[node] == site) {
    place = places_[node];
  } else if (node == fans_[site].centre) {  // two sites on one vertex
  } else if (const DirectArc* direct = fan_arc(site, node)) {
    place = place_direct(*direct);
  } else if (in_own_face(node, site, vector)) {
    return true;
  } else if (!place_by_cell(node, site, scratch, place)) {
    return false;
  }
  vector = vector_of(place);
  return true;
}

/// Next to vertices of the site's own cell, if it has any.
bool SiteMaps::place_by_cell(Index node, Index site, Scratch& scratch, Place& place) const {
  if (first_node_[site] == first_node_[site + 1]) return false;
  return beside_own(node, site, scratch, place) || place_beside(node, site, &scratch, place) ||
         place_through_neighbour(node, site, scratch, place);
}

/// The corners of its face a site sees straight, even where its fan leaves them out.
bool SiteMaps::in_own_face(Index node, Index site, SiteVector& vector) const {
  if (fans_[site].centre != k_none) return false;
  const Triangle& t = mesh_.triangles()[sites_[site].face];
  const auto corner = std::find(t.begin(), t.end(), graph_.vertex_of(node));
  if (corner == t.end()) return false;
  const FaceChart chart(mesh_, sites_[site].face);
  vector.log = chart.corner[corner - t.begin()] - chart.to_plane(sites_[site].barycentric);
  vector.distance = vector.log.norm();
  return true;
}

SiteVector SiteMaps::laid_beside(Index halfedge, const SiteVector& from, const SiteVector& to) const {
  Vec2 along = to.log - from.log;
  along = along.norm() > 0 ? along.normalized() : Vec2(1, 0);
  const Vec2& apex = graph_.unfolding().apex(halfedge);
  const Vec2 log = from.log + apex.x() * along + apex.y() * Vec2(-along.y(), along.x());
  return {log, log.norm()};
}

/// By the nearest way over a graph neighbour that the site owns.
bool SiteMaps::place_through_neighbour(Index node, Index site, Scratch& scratch, Place& place) const {
  double best = k_infinity;
  Index through = k_none;
  const ArcRows& arcs = graph_.arcs();
  for (std::int64_t arc = arcs.first(node); arc < arcs.first(node + 1); ++arc) {
    const Index neighbour = arcs.target(arc);
    if (label_[neighbour] != site || distance_[neighbour] + arcs.length(arc) >= best) continue;
    best = distance_[neighbour] + arcs.length(arc);
    through = neighbour;
  }
  if (through == k_none || through == fans_[site].centre) return false;
  place = place_after(node, through, scratch);
  return true;
}

}  // namespace saddleback
