// Method: labels by shortest paths in the graph; then each cell's vertices are placed in order of their distance. A
// vertex next to another site's cell is placed from vertices of that cell alone: the last bit of the path leaves the
// cell, all before lies inside (cells are star-shaped).

#include "tessellation/site_maps.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "geodesics/direct_fans.h"
#include "geodesics/label_propagation.h"
#include "support/parallel.h"

namespace saddleback {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();

// Less excess of angle than this bends wavefronts so little (its square an eighth, relative to the distance) that what
// lies behind the vertex may be seen across edges as if straight.
constexpr double k_flat_excess = 0.1;

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

void sort_by_vertex(std::vector<DirectArc>& arcs) {
  std::sort(arcs.begin(), arcs.end(), [](const DirectArc& a, const DirectArc& b) { return a.vertex < b.vertex; });
}

bool bends_much(const Mesh& mesh, Index vertex) {
  return mesh.total_angle(vertex) > (mesh.is_boundary(vertex) ? M_PI : 2 * M_PI) + k_flat_excess;
}

}  // namespace

SiteMaps::SiteMaps(const SaddleVertexGraph& graph, const SurfacePoints& sites, int threads, const JobStage& stage)
    : graph_(graph),
      mesh_(graph.mesh()),
      sites_(sites),
      slack_(std::max(2 * graph.accuracy(), k_least_slack)),
      fans_(sites.size()),
      places_(graph.mesh().vertex_count()),
      placed_(graph.mesh().vertex_count(), 0) {
  make_fans(threads, stage.part(0, 0.3));
  label_vertices(stage);
  group_vertices();
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

void SiteMaps::make_fans(int threads, const JobStage& stage) {
  for_each_fan(graph_, sites_, FanAngles::both, threads, stage, [&](Index site, std::span<const DirectArc> arcs) {
    Fan& fan = fans_[site];
    fan.arcs.assign(arcs.begin(), arcs.end());
    for (DirectArc& arc : fan.arcs) arc.length = graph_.arcs().codec().round(arc.length);
  });
  std::vector<Index> at_vertices;
  for (Index site = 0; site < site_count(); ++site) {
    fans_[site].centre = vertex_at(mesh_, sites_[site]);
    if (fans_[site].centre != k_none) at_vertices.push_back(site);
  }
  parallel_for(static_cast<Index>(at_vertices.size()), threads, 16, [&](Index i, int) {
    stage.check();
    make_fan_at_vertex(fans_[at_vertices[i]]);
  });
}

void SiteMaps::make_fan_at_vertex(Fan& fan) {
  const double scale = mesh_.is_boundary(fan.centre) ? 1 : 2 * M_PI / mesh_.total_angle(fan.centre);
  const Index node = graph_.node_of(fan.centre);
  const ArcRows& arcs = graph_.arcs();
  ArcUnfolder unfolder(graph_.unfolding());
  UnfoldedArc unfolded;
  for (std::int64_t arc = arcs.first(node); arc < arcs.first(node + 1); ++arc) {
    unfolder.unfold(graph_.hint(node, arc), unfolded);
    const Index target = graph_.vertex_of(arcs.target(arc));
    fan.arcs.push_back({target, arcs.length(arc), scale * unfolded.start_angle, unfolded.end_angle});
  }
  sort_by_vertex(fan.arcs);
}

void SiteMaps::label_vertices(const JobStage& stage) {
  std::vector<Seed> seeds;
  for (Index site = 0; site < site_count(); ++site) {
    const Fan& fan = fans_[site];
    if (fan.centre != k_none) seeds.push_back({fan.centre, site, 0});
    for (const DirectArc& arc : fan.arcs) seeds.push_back({arc.vertex, site, arc.length});
  }
  LabelField field = propagate_labels(graph_, seeds, {}, false, stage.part(0.3, 0.8));
  label_ = std::move(field.source);
  distance_ = std::move(field.distance);
}

void SiteMaps::group_vertices() {
  first_vertex_.assign(site_count() + 1, 0);
  for (const Index site : label_) ++first_vertex_[site + 1];
  for (Index site = 0; site < site_count(); ++site) first_vertex_[site + 1] += first_vertex_[site];
  vertices_.resize(label_.size() + 1);  // one more: the last cells may be without any
  std::vector<Index> cursor(first_vertex_.begin(), first_vertex_.end() - 1);
  for (Index v = 0; v < mesh_.vertex_count(); ++v) vertices_[cursor[label_[v]]++] = v;
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
  const auto first = vertices_.begin() + first_vertex_[site], last = vertices_.begin() + first_vertex_[site + 1];
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
  for (auto v = first; v != last; ++v) {
    if (placed_[*v]) continue;
    if (!place_own(*v, site, places_[*v])) {
      places_[*v] = place_after(*v, previous_vertex(graph_, distance_, label_, *v), scratch);
    }
    placed_[*v] = 1;
  }
}

const DirectArc* SiteMaps::fan_arc(Index site, Index vertex) const {
  const auto& arcs = fans_[site].arcs;
  const auto found = std::lower_bound(arcs.begin(), arcs.end(), vertex,
                                      [](const DirectArc& arc, Index wanted) { return arc.vertex < wanted; });
  return found != arcs.end() && found->vertex == vertex ? &*found : nullptr;
}

SiteMaps::Place SiteMaps::place_direct(const DirectArc& arc) const {
  return {polar(arc.length, arc.start_angle), arc.length, arc.end_angle, k_none};
}

/// Whether a path may bend where it comes from `back` and goes on towards `out`, so much that it counts.
bool SiteMaps::is_anchor(Index vertex, double back, double out) const {
  return bends_much(mesh_, vertex) && turn_at(mesh_, vertex, back, out) == 0;
}

SiteMaps::Place SiteMaps::place_after(Index vertex, Index previous, Scratch& scratch) const {
  const Place& before = places_[previous];
  const Index node = graph_.node_of(previous);
  const std::int64_t arc = graph_.arcs().find(node, graph_.node_of(vertex));
  scratch.unfolder.unfold(graph_.hint(node, arc), scratch.unfolded);
  const double length = graph_.arcs().length(arc), out = scratch.unfolded.start_angle;
  if (is_anchor(previous, before.back, out)) {
    return {polar(length, out - before.back), before.distance + length, scratch.unfolded.end_angle, previous};
  }
  const double heading = std::atan2(before.at.y(), before.at.x()) + turn_at(mesh_, previous, before.back, out);
  const Vec2 step = polar(length, heading), at = before.at + step;
  return {at, anchor_distance(before) + at.norm(), scratch.unfolded.end_angle + angle_between(step, at), before.anchor};
}

/// False where the lengths make no triangle, or the ray passes an end that is not nearly flat.
bool SiteMaps::see(Index halfedge, const Place& from, const Place& to, Sight& sight) const {
  if (from.anchor != to.anchor) return false;
  const double length = mesh_.length(halfedge), a = from.at.squaredNorm(), b = to.at.squaredNorm();
  // The edge runs along the x axis, the corner above, the anchor below.
  const double x = (a - b + length * length) / (2 * length), y = a - x * x;
  if (!(y > k_end_on * length * length)) return false;
  sight.anchor = Vec2(x, -std::sqrt(y));
  sight.ray = graph_.unfolding().apex(halfedge) - sight.anchor;
  const double at_edge = x - sight.ray.x() * sight.anchor.y() / sight.ray.y();
  sight.beyond = at_edge < 0 ? at_edge / length : std::max(0.0, at_edge / length - 1);
  sight.distance = sight.ray.norm();
  return sight.beyond == 0 || !bends_much(mesh_, sight.beyond < 0 ? mesh_.from(halfedge) : mesh_.to(halfedge));
}

/// The direction divides the angle between those of the edge's ends as the ray divides it in the edge's frame.
SiteMaps::Place SiteMaps::place_by(const Sight& sight, Index halfedge, const Place& from, const Place& to) const {
  const Vec2 to_start = -sight.anchor, to_end = Vec2(mesh_.length(halfedge), 0) - sight.anchor;
  const double share = angle_between(to_start, sight.ray) / angle_between(to_start, to_end);
  const double angle = std::atan2(from.at.y(), from.at.x()) + share * angle_between(from.at, to.at);
  Place place{polar(sight.distance, angle), sight.distance, 0, from.anchor};
  place.distance += anchor_distance(place);
  const Vec2& apex = graph_.unfolding().apex(halfedge);
  place.back = graph_.unfolding().polar(Mesh::prev(halfedge)) + angle_between(Vec2(-apex), Vec2(-sight.ray));
  return place;
}

/// Places a vertex of the site's own cell beyond an edge whose ends are placed already: the first that leads to the
/// graph's distance or little less. False where there is none.
bool SiteMaps::place_own(Index vertex, Index site, Place& place) const {
  const double most = distance_[vertex] * (1 + k_arc_rounding), least = (1 - slack_) * most;
  const Index first = mesh_.first_halfedge(vertex);
  for (Index h = first; h != k_none;) {
    const Index edge = Mesh::next(h), a = mesh_.from(edge), b = mesh_.to(edge);
    h = mesh_.rotate(h);
    if (h == first) h = k_none;
    if (label_[a] != site || label_[b] != site || !placed_[a] || !placed_[b]) continue;
    const Place &from = places_[a], &to = places_[b];
    Sight sight;
    if (!see(edge, from, to, sight) || std::abs(sight.beyond) > k_least_miss) continue;
    const double distance = anchor_distance(from) + sight.distance;
    if (distance > most || distance < least) continue;
    place = place_by(sight, edge, from, to);
    return true;
  }
  return false;
}

/// An end of an edge as the site sees it; the site's own or, where `deep`, any that can be placed beside its own.
bool SiteMaps::end_of_edge(Index vertex, Index site, Scratch* deep, Place& place) const {
  if (label_[vertex] != site) return deep && beside_own(vertex, site, *deep, place);
  place = places_[vertex];
  return placed_[vertex] != 0;
}

/// Beyond edges of the site's own vertices; remembered.
bool SiteMaps::beside_own(Index vertex, Index site, Scratch& scratch, Place& place) const {
  Scratch::Beside& entry = scratch.beside[static_cast<std::size_t>(vertex) % Scratch::k_beside];
  if (entry.vertex != vertex || entry.site != site) {
    entry.vertex = vertex;
    entry.site = site;
    entry.found = place_beside(vertex, site, nullptr, entry.place);
  }
  place = entry.place;
  return entry.found;
}

/// Places a vertex beyond the edge across which the site is seen best: between the edge's ends if there is one, else
/// least beside them; among equals the shortest way.
bool SiteMaps::place_beside(Index vertex, Index site, Scratch* deep, Place& place) const {
  Sight best;
  Index best_edge = k_none;
  Place best_from, best_to;
  const Index first = mesh_.first_halfedge(vertex);
  for (Index h = first; h != k_none;) {
    const Index edge = Mesh::next(h), a = mesh_.from(edge), b = mesh_.to(edge);
    h = mesh_.rotate(h);
    if (h == first) h = k_none;
    if (label_[a] != site && label_[b] != site) continue;
    Place from, to;
    Sight found;
    if (!end_of_edge(a, site, deep, from) || !end_of_edge(b, site, deep, to) || !see(edge, from, to, found)) continue;
    const double beyond = std::abs(found.beyond), best_beyond = std::abs(best.beyond);
    const bool better =
        best_edge == k_none || beyond < best_beyond || (beyond == best_beyond && found.distance < best.distance);
    if (better) best = found, best_edge = edge, best_from = from, best_to = to;
  }
  if (best_edge == k_none) return false;
  place = place_by(best, best_edge, best_from, best_to);
  return true;
}

/// What lies behind an anchor is seen in its direction.
SiteVector SiteMaps::vector_of(const Place& place) const {
  if (place.anchor == k_none) return {place.at, place.distance};
  return {place.distance * vector_of(places_[place.anchor]).log.normalized(), place.distance};
}

bool SiteMaps::find(Index site, Index vertex, Scratch& scratch, SiteVector& vector) const {
  Place place;
  if (label_[vertex] == site) {
    place = places_[vertex];
  } else if (vertex == fans_[site].centre) {  // two sites on one vertex
  } else if (const DirectArc* direct = fan_arc(site, vertex)) {
    place = place_direct(*direct);
  } else if (in_own_face(vertex, site, vector)) {
    return true;
  } else if (!beside_own(vertex, site, scratch, place) && !place_beside(vertex, site, &scratch, place) &&
             !place_through_neighbour(vertex, site, scratch, place)) {
    return false;
  }
  vector = vector_of(place);
  return true;
}

/// The corners of its face a site sees straight, even where its fan leaves them out.
bool SiteMaps::in_own_face(Index vertex, Index site, SiteVector& vector) const {
  if (fans_[site].centre != k_none) return false;
  const Triangle& t = mesh_.triangles()[sites_[site].face];
  const auto corner = std::find(t.begin(), t.end(), vertex);
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
bool SiteMaps::place_through_neighbour(Index vertex, Index site, Scratch& scratch, Place& place) const {
  double best = k_infinity;
  Index through = k_none;
  const ArcRows& arcs = graph_.arcs();
  const Index node = graph_.node_of(vertex);
  for (std::int64_t arc = arcs.first(node); arc < arcs.first(node + 1); ++arc) {
    const Index neighbour = graph_.vertex_of(arcs.target(arc));
    if (label_[neighbour] != site || distance_[neighbour] + arcs.length(arc) >= best) continue;
    best = distance_[neighbour] + arcs.length(arc);
    through = neighbour;
  }
  if (through == k_none || through == fans_[site].centre) return false;
  place = place_after(vertex, through, scratch);
  return true;
}

}  // namespace saddleback
