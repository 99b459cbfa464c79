// Method: once vertices have labels (site_labels.cpp), each cell's are placed in order of their distance. A vertex next
// to another site's cell is placed from vertices of that cell alone: the last bit of the path leaves the cell, all
// before lies inside (cells are star-shaped).

#include "tessellation/log_map/site_maps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "geodesics/unfolding/face_strip.h"
#include "support/planar.h"
#include "support/threads/parallel.h"
#include "tessellation/log_map/interpolated_direction.h"

namespace saddleback {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();

// Straight lines are shorter than paths in a graph by its error; more than this is no straight line on the surface.
constexpr double k_least_slack = 1e-2;

// Of arcs, see ArcCodec. Ways that differ by less are equally long: which of them is shorter changes with the mesh's
// scale and place, so that it is their order or kind that decides.
constexpr double k_arc_rounding = 2e-9;

// An edge's end that a ray passes by less than this share of the edge's length it may as well hit.
constexpr double k_least_miss = 1e-3;

// By less than this share it does hit the end, but for rounding.
constexpr double k_hit = 1e-9;

// Radians: a path that turns less goes straight on, but for rounding.
constexpr double k_least_turn = 1e-9;

// How many nodes ahead what lies around a node is fetched from memory: by distance they follow in no order of memory.
// The first of a cell are fetched while the cell before is placed.
constexpr int k_ahead = 8;
constexpr std::size_t k_fetched_seen = 48, k_line = 64;

// Square of the least angle at which an edge must be seen: what lies beyond one seen end-on cannot be told from it.
constexpr double k_end_on = 1e-10;
// The same where only the roundings of the two distances to its ends tell it from one seen end-on, see there.
constexpr double k_end_on_rounded = 1e-8;

// A triangle of the site and an edge whose sides fit this well, relative to the longer ones, is flat but for rounding:
// where anything bends the surface inside, sides fit by an accident alone.
constexpr double k_fits = 1e-11;

/// Whether an edge of this length fits between two places in a plane.
bool fits(const Vec2& from, const Vec2& to, double length) {
  const double excess = (to - from).squaredNorm() - length * length;
  return excess * excess <= 4 * k_fits * k_fits * length * length * std::max(from.squaredNorm(), to.squaredNorm());
}

/// Whether a place at this distance from its anchor is seen straight: a way that bends to it is longer.
bool is_straight(const Vec2& at, double distance) { return std::abs(at.norm() - distance) < k_fits * distance; }

Vec2 polar(double length, double angle) { return {length * std::cos(angle), length * std::sin(angle)}; }

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

/// Whether a mesh is a flat disk, however it is rolled: whatever fits a plane there is in it.
bool is_flat_disk(const Mesh& mesh) {
  constexpr double k_flat = 1e-12;  // radians, of roundings of a vertex's angles
  if (mesh.component_count() > 1 || mesh.genus() > 0 || mesh.boundary_loops().size() != 1) return false;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (!mesh.is_boundary(v) && std::abs(mesh.total_angle(v) - 2 * M_PI) > k_flat) return false;
  return true;
}

/// How long the straight line is that leads from `corner`, opposite a half-edge, across it to `end`, which is expected
/// at `goal`; all in the frame of the half-edge. None where something else is there, or nothing. O(faces crossed).
std::optional<double> line_across(const Unfolding& unfolding, Index halfedge, const Vec2& corner, const Vec2& goal,
                                  const LegEnd& end) {
  constexpr double k_same_place = 1e-9;  // of the length
  const Mesh& mesh = unfolding.mesh();
  const double tolerance = k_same_place * (goal - corner).norm();
  Vec2 from(mesh.length(halfedge), 0), to = Vec2::Zero();
  Index h = mesh.twin(halfedge);
  for (Index faces = mesh.face_count(); h != k_none && faces > 0; --faces) {
    const Vec2 along = (to - from) / mesh.length(h);
    const Vec2& offset = unfolding.apex(h);
    const Vec2 apex = from + offset.x() * along + offset.y() * Vec2(-along.y(), along.x());
    if (end.is_vertex() ? mesh.apex(h) == end.vertex : Mesh::face_of(h) == end.point.face) {
      const Vec3& b = end.point.barycentric;
      const Vec2 place =
          end.is_vertex() ? apex : b[h % 3] * from + b[Mesh::next(h) % 3] * to + b[Mesh::prev(h) % 3] * apex;
      if ((place - goal).norm() <= tolerance) return (place - corner).norm();
    }
    const bool is_left = cross(goal - corner, apex - corner) > 0;
    h = mesh.twin(is_left ? Mesh::next(h) : Mesh::prev(h));
    (is_left ? from : to) = apex;
    if (cross(to - from, goal - from) < -tolerance * (to - from).norm()) break;  // the line ended before
  }
  return {};
}

}  // namespace

SiteMaps::SiteMaps(const SaddleVertexGraph& graph, const VertexRings& rings, CellLengths lengths, int cuda_device)
    : graph_(graph),
      mesh_(graph.mesh()),
      rings_(rings),
      lengths_(lengths),
      cuda_device_(cuda_device),
      slack_(std::max(2 * graph.accuracy(), k_least_slack)),
      is_flat_disk_(is_flat_disk(graph.mesh())),
      places_(graph.mesh().vertex_count()) {}

void SiteMaps::Scratch::forget() {
  site = k_none;
  ++age;
}

void SiteMaps::label_nodes(const SurfacePoints& sites, std::span<const double> reaches,
                           const std::optional<std::vector<Index>>& others, int threads, const JobStage& stage) {
  keeps_any_ = others && 2 * others->size() <= sites.size();  // else labels are found as soon from the start
  sites_ = sites;
  order_sites();
  if (!keeps_any_) {
    fans_.resize(sites.size());
    limits_.resize(sites.size());
  }
  is_kept_.assign(sites.size(), keeps_any_);
  if (keeps_any_)
    for (const Index site : *others) is_kept_[site] = 0;
  make_fans(reaches, threads, stage.part(0, 0.5));
  if (keeps_any_) {
    label_again(*others, stage.part(0.5, 1));
  } else {
    label_all(threads, stage.part(0.5, 1));
  }
}

/// Of the sites that are not kept.
void SiteMaps::make_fans(std::span<const double> reaches, int threads, const JobStage& stage) {
  // Sites are asked for so much more than they reach, that they may reach farther; beside cells that stay they may soon
  // reach much farther.
  constexpr double k_growth = 1.1, k_growth_of_few = 1.6;
  parallel_for(site_count(), threads, 256, [&](Index i, int) {
    const Index site = order_[i];
    if (is_kept(site)) return;
    const Index vertex = vertex_at(mesh_, sites_[site]);
    fans_[site].center = vertex == k_none ? k_none : graph_.node_of(vertex);
    fans_[site].corners = rings_.face(rings_.face_of(sites_[site].face)).nodes;
    limits_[site] = reaches.empty() ? k_infinity : (keeps_any_ ? k_growth_of_few : k_growth) * reaches[site];
  });
  std::vector<Index> at_vertices, inside;
  SurfacePoints points;
  std::vector<double> limits;
  for (const Index site : order_) {
    if (is_kept(site)) continue;
    if (fans_[site].center != k_none) {
      at_vertices.push_back(site);
      continue;
    }
    inside.push_back(site);
    points.push_back(sites_[site]);
    if (!reaches.empty()) limits.push_back(limits_[site]);
  }
  const ArcCodec& codec = graph_.arcs().codec();
  for_each_view(graph_, points, limits, threads, stage, [&](Index i, const SeenView& view) {
    Fan& fan = fans_[inside[i]];
    fan.resize(view.size());
    view.visit([&](std::size_t k, const SeenNode& node) { fan.set(k, node, codec.round(node.length)); });
    fan.set_arcs(static_cast<std::ptrdiff_t>(view.arc_count()));
  });
  parallel_for(static_cast<Index>(at_vertices.size()), threads, 16, [&](Index i, int) {
    stage.check();
    make_fan_at_vertex(fans_[at_vertices[i]]);
  });
}

void SiteMaps::Fan::resize(std::size_t count) {
  nodes.resize(count);
  rounded.resize(count);
  places.resize(count);
  across.resize(count);
}

void SiteMaps::Fan::set(std::size_t i, const SeenNode& node, double length_rounded) {
  nodes[i] = node.node;
  rounded[i] = length_rounded;
  places[i] = node.place;
  across[i] = {node.from, node.edge};
}

void SiteMaps::Fan::set_arcs(std::ptrdiff_t count) {
  arc_count = static_cast<std::size_t>(count);
  first = count == 0 ? 0 : *std::min_element(nodes.begin(), nodes.begin() + count);
  last = count == 0 ? -1 : *std::max_element(nodes.begin(), nodes.begin() + count);
}

void SiteMaps::make_fan_at_vertex(Fan& fan) {
  const Index node = fan.center, vertex = graph_.vertex_of(node);
  const double scale = mesh_.is_boundary(vertex) ? 1 : 2 * M_PI / mesh_.total_angle(vertex);
  const ArcRows& arcs = graph_.arcs();
  ArcUnfolder unfolder(graph_.unfolding());
  UnfoldedArc unfolded;
  const std::int64_t begin = arcs.first(node), count = arcs.first(node + 1) - begin;
  fan.resize(static_cast<std::size_t>(count));
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t arc = begin + i;
    const double rounded = arcs.length(arc);
    const double length = unfolder.unfold(graph_.hint(node, arc), unfolded) ? unfolded.length : rounded;
    const Vec2 place = polar(length, scale * unfolded.start_angle);
    fan.set(static_cast<std::size_t>(i), {arcs.target(arc), k_none, true, length, place, Vec2(unfolded.end_angle, 0)},
            rounded);
  }
  fan.set_arcs(count);
}

void SiteMaps::fetch_cell(Index site) const {
  const auto own = nodes(site);
  for (const Index node : own.first(std::min<std::size_t>(own.size(), k_ahead))) {
    fetch(node);
    rings_.fetch(node);
  }
  const Fan& fan = fans_[site];
  const std::size_t count = std::min(fan.nodes.size(), k_fetched_seen);
  for (std::size_t i = 0; i < count; i += k_line / sizeof(Index)) __builtin_prefetch(&fan.nodes[i]);
  for (std::size_t i = 0; i < count; i += k_line / sizeof(double)) __builtin_prefetch(&fan.rounded[i]);
  for (std::size_t i = 0; i < count; i += k_line / sizeof(PackedVec2)) __builtin_prefetch(&fan.places[i]);
}

void SiteMaps::place_cell(Index site, Scratch& scratch) {
  const auto first = nodes_.begin() + first_node_[site], last = nodes_.begin() + first_node_[site + 1];
  std::sort(first, last,
            [&](Index a, Index b) { return distance_[a] != distance_[b] ? distance_[a] < distance_[b] : a < b; });
  for (auto node = first; node != last; ++node) places_[*node].found_by = k_unplaced;
  scratch.site = site;
  ++scratch.round;
  scratch.answers.clear();
  const Fan& fan = fans_[site];
  // Straight ones first: each may serve as the end of an edge that others are seen across. A line that grazes a vertex
  // is as long as the path over it, and is the better: what is seen behind changes where that vertex is an anchor.
  for (std::size_t i = 0; i < fan.nodes.size(); ++i) {
    const Index node = fan.nodes[i];
    scratch.table[node] = {scratch.round, static_cast<Index>(i)};
    const double most = distance_[node] * (1 + k_arc_rounding);
    if (label_[node] != site || fan.rounded[i] > most) continue;
    const std::optional<Vec2> place =
        i < fan.arc_count || is_smooth() ? fan.places[i] : seen_truly(site, node, fan.places[i]);
    if (place) places_[node] = place_straight(*place);
  }
  if (fan.center != k_none && label_[fan.center] == site) places_[fan.center] = {.found_by = k_center};
  for (auto node = first; node != last; ++node) {
    if (last - node > k_ahead) rings_.fetch(node[k_ahead]);
    if (places_[*node].found_by != k_unplaced) continue;
    Place place;
    if (!place_own(*node, site, place)) {
      const Index previous = node_before(*node, site, distance_[*node]);
      // None is nearer where an arc is shorter than the rounding of the whole path.
      place = previous != k_none ? place_after(*node, previous, scratch) : place_straight(Vec2(distance_[*node], 0));
    }
    // Beside short edges what an arc is when it is laid out may be longer than the arc.
    if (place.distance > distance_[*node] * (1 + k_arc_rounding)) place.distance = distance_[*node];
    places_[*node] = place;
  }
}

/// Where a node lies that the waves see, in single precision, past another vertex: beside short edges what is a little
/// hidden is nearer by more than rounding. None where the straight line leads elsewhere.
std::optional<Vec2> SiteMaps::seen_truly(Index site, Index node, const Vec2& place) const {
  const Index face = sites_[site].face;
  const FaceChart chart(mesh_, face);
  const Vec2 center = chart.to_plane(sites_[site].barycentric);
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

/// Which of a site's fan a node is; k_none for none of it.
Index SiteMaps::find_in_fan(Index site, Index node) const {
  const auto& nodes = fans_[site].nodes;
  const auto found = std::ranges::find(nodes, node);
  return found != nodes.end() ? static_cast<Index>(found - nodes.begin()) : k_none;
}

/// The same, sooner for the site that was placed last.
Index SiteMaps::find_seen(Index site, Index node, const Scratch& scratch) const {
  if (scratch.site != site) return find_in_fan(site, node);
  const Scratch::Known known = scratch.table[node];
  return known.round == scratch.round && known.at >= 0 ? known.at : k_none;
}

/// Whether a path may bend where it comes from `back` and goes on towards `out`, so much that it counts. One that goes
/// on straight may, too.
bool SiteMaps::is_anchor(Index vertex, double back, double out) const {
  return VertexRings::bends_much(mesh_, vertex) && std::abs(turn_at(mesh_, vertex, back, out)) <= k_least_turn;
}

/// The last of a site's nodes on a path to the node that is as short as the shortest, but for the roundings of arcs; of
/// several the one with the longest arc, of those the first.
Index SiteMaps::node_before(Index node, Index site, double shortest) const {
  const ArcRows& arcs = graph_.arcs();
  const double most = shortest * (1 + k_arc_rounding);
  Index before = k_none;
  double longest = 0;
  for (std::int64_t arc = arcs.first(node); arc < arcs.first(node + 1); ++arc) {
    const Index other = arcs.target(arc);
    if (label_[other] != site || distance_[other] >= shortest) continue;
    const double length = arcs.length(arc);
    if (distance_[other] + length > most || length <= longest * (1 + k_arc_rounding)) continue;
    longest = length;
    before = other;
  }
  return before;
}

SiteMaps::Place SiteMaps::place_after(Index node, Index previous, Scratch& scratch) const {
  return place_after(node, previous, places_[previous], direction_back(previous, scratch), scratch);
}

/// `back`: to the anchor of the node before.
SiteMaps::Place SiteMaps::place_after(Index node, Index previous, const Place& before, double back,
                                      Scratch& scratch) const {
  const Index vertex = graph_.vertex_of(previous);
  const std::int64_t arc = graph_.arcs().find(previous, node);
  const bool unfolds = scratch.unfolder.unfold(graph_.hint(previous, arc), scratch.unfolded);
  const double length = unfolds ? scratch.unfolded.length : graph_.arcs().length(arc);
  const double out = scratch.unfolded.start_angle;
  const double distance = before.distance + length;
  if (is_anchor(vertex, back, out)) return {polar(length, out - back), distance, previous, k_after_another};
  const double heading = std::atan2(before.at.y(), before.at.x()) + turn_at(mesh_, vertex, back, out);
  return {before.at + polar(length, heading), distance, before.anchor, k_after_another};
}

/// To the anchor of a placed node, surface angle at the node. Few are asked for it.
double SiteMaps::direction_back(Index node, Scratch& scratch) const {
  const Place& place = places_[node];
  if (place.found_by == k_center) return 0;
  if (place.found_by == k_straight) {
    return direction_back_to(label_[node], find_in_fan(label_[node], node));
  }
  if (place.found_by == k_after_another) {
    const Index previous = node_before(node, label_[node], distance_[node]);
    scratch.unfolder.unfold(graph_.hint(previous, graph_.arcs().find(previous, node)), scratch.unfolded);
    const double back = scratch.unfolded.end_angle;
    return place.anchor == previous ? back : back + angle_between(place.at - places_[previous].at, place.at);
  }
  const Wedge& wedge = rings_.wedge(place.found_by);
  Sight sight;
  see(wedge, places_[wedge.from], places_[wedge.to], sight);
  return graph_.unfolding().polar(Mesh::prev(rings_.halfedge(wedge.side))) +
         angle_between(Vec2(-wedge.apex), Vec2(-sight.ray));
}

/// The same to a site that sees a node straight.
double SiteMaps::direction_back_to(Index site, Index seen) const {
  const Fan& fan = fans_[site];
  const auto& [from, edge] = fan.across[seen];
  return saddleback::direction_back(graph_,
                                    {fan.nodes[seen], edge, true, fan.places[seen].norm(), fan.places[seen], from});
}

/// False where the anchor is on the corner's own side of the edge, where the lengths make no triangle, or where the ray
/// passes an end that is not nearly flat.
bool SiteMaps::see(const Wedge& wedge, const Place& from, const Place& to, Sight& sight) {
  const double length = wedge.length, square = length * length, side = cross(to.at, from.at);
  // Ends on one ray, as those after one vertex may be, are on one side or the other by rounding alone.
  if (from.anchor != to.anchor || !(side > 0 && side * side > k_end_on * square * square)) return false;
  const double a = from.at.squaredNorm(), b = to.at.squaredNorm();
  // The edge runs along the x axis, the corner above, the anchor below.
  const double x = (a - b + length * length) / (2 * length), y = a - x * x;
  // Distances that are wrong by e, relative, move x by 2 e a / length and y by 2 x times that: no more than
  // 2 e a (a + square) / square.
  if (!(y > k_end_on * square && y * square > k_end_on_rounded * a * (a + square))) return false;
  sight.anchor = Vec2(x, -std::sqrt(y));
  sight.ray = wedge.apex - sight.anchor;
  const double at_edge = x - sight.ray.x() * sight.anchor.y() / sight.ray.y();
  const double miss = at_edge < 0 ? at_edge / length : std::max(0.0, at_edge / length - 1);
  sight.beyond = std::abs(miss) > k_hit ? miss : 0;
  sight.distance = sight.ray.norm();
  sight.is_flat = sight.beyond == 0 && fits(from.at, to.at, length);
  return sight.beyond == 0 || !(sight.beyond < 0 ? wedge.from_bends : wedge.to_bends);
}

/// At an infinite distance unless that is known to be the straight one.
SiteMaps::Place SiteMaps::place_by(const Sight& sight, const Wedge& wedge, const Place& from, const Place& to) const {
  const Vec2 to_start = -sight.anchor, to_end = Vec2(wedge.length, 0) - sight.anchor;
  Place place{seen_between(from.at, to.at, to_start, to_end, sight.ray), k_infinity, from.anchor, rings_.index(wedge)};
  if (sight.is_flat) place.distance = sight.distance + anchor_distance(place);
  return place;
}

/// Places a node of the site's own cell beyond an edge whose ends are placed already: the first that leads to the
/// graph's distance or little less, else the one that leads to the least more, at the graph's distance. False where
/// there is none.
bool SiteMaps::place_own(Index node, Index site, Place& place) const {
  const double most = distance_[node] * (1 + k_arc_rounding), least = (1 - slack_) * most;
  double shortest = (1 + slack_) * most;
  const Wedge* detour = nullptr;
  for (const Wedge& wedge : rings_.around(node)) {
    if (label_[wedge.from] != site || label_[wedge.to] != site) continue;
    const Place &from = places_[wedge.from], &to = places_[wedge.to];
    if (from.found_by == k_unplaced || to.found_by == k_unplaced) continue;
    Sight sight;
    if (!see(wedge, from, to, sight) || std::abs(sight.beyond) > k_least_miss) continue;
    const double to_anchor = anchor_distance(from);
    if (to_anchor >= distance_[node]) continue;
    sight.is_flat =
        sight.is_flat && is_straight(from.at, from.distance - to_anchor) && is_straight(to.at, to.distance - to_anchor);
    const double distance = anchor_distance(from) + sight.distance;
    if (distance < least || distance >= shortest * (1 - k_arc_rounding)) continue;
    place = place_by(sight, wedge, from, to);
    if (distance <= most) {
      const std::optional<double> straight =
          sight.is_flat ? line_to_anchor(wedge, sight, place.anchor, site) : std::nullopt;
      if (straight) place.at *= *straight / place.at.norm();
      place.distance = straight ? std::min(to_anchor + *straight, distance_[node]) : distance_[node];
      return true;
    }
    shortest = distance;
    detour = &wedge;
  }
  if (!detour) return false;
  const double straight = distance_[node] - anchor_distance(place);
  place.at *= straight / place.at.norm();
  place.distance = distance_[node];
  return true;
}

/// Ways on both sides of a hole, or of a bump, fit a plane as well as those around nothing do: what tells is the line.
std::optional<double> SiteMaps::line_to_anchor(const Wedge& wedge, const Sight& sight, Index anchor, Index site) const {
  if (is_flat_disk_) return sight.distance;
  const Index node = anchor != k_none ? anchor : fans_[site].center;
  const LegEnd end = node != k_none ? leg_end(mesh_, graph_.vertex_of(node)) : leg_end(mesh_, sites_[site]);
  return line_across(graph_.unfolding(), rings_.halfedge(wedge.side), wedge.apex, sight.anchor, end);
}

/// An end of an edge as the site sees it; the site's own or, where `deep`, any that can be placed beside its own. Null
/// where there is none.
const SiteMaps::Place* SiteMaps::end_of_edge(Index node, Index site, Scratch* deep, Place& place) const {
  if (label_[node] == site) return &places_[node];
  return deep && beside_own(node, site, *deep, place) ? &place : nullptr;
}

/// Beyond edges of the site's own cell; remembered.
bool SiteMaps::beside_own(Index node, Index site, Scratch& scratch, Place& place) const {
  Scratch::Beside& entry = scratch.beside[slot_of(site, node) % Scratch::k_beside];
  if (entry.age != scratch.age || entry.node != node || entry.site != site) {
    entry.age = scratch.age;
    entry.node = node;
    entry.site = site;
    entry.found = place_beside(node, site, nullptr, entry.place);
  }
  place = entry.place;
  return entry.found;
}

/// Places a node beyond the edge across which the site is seen best: between the edge's ends if there is one, else
/// least beside them; among equals the shortest way, of several the first.
bool SiteMaps::place_beside(Index node, Index site, Scratch* deep, Place& place) const {
  Sight best;
  const Wedge* best_wedge = nullptr;
  Place best_from, best_to;
  for (const Wedge& wedge : rings_.around(node)) {
    const bool owns_from = label_[wedge.from] == site, owns_to = label_[wedge.to] == site;
    if (deep ? !owns_from && !owns_to : !owns_from || !owns_to) continue;
    Place from_memory, to_memory;
    const Place* const from = end_of_edge(wedge.from, site, deep, from_memory);
    const Place* const to = from ? end_of_edge(wedge.to, site, deep, to_memory) : nullptr;
    Sight found;
    if (!to || !see(wedge, *from, *to, found)) continue;
    const double nearer = std::abs(best.beyond) - std::abs(found.beyond);
    const bool better =
        !best_wedge || nearer > k_hit || (nearer >= -k_hit && found.distance < best.distance * (1 - k_arc_rounding));
    if (better) best = found, best_wedge = &wedge, best_from = *from, best_to = *to;
  }
  if (!best_wedge) return false;
  const double to_anchor = anchor_distance(best_from);
  best.is_flat = best.is_flat && is_straight(best_from.at, best_from.distance - to_anchor) &&
                 is_straight(best_to.at, best_to.distance - to_anchor);
  place = place_by(best, *best_wedge, best_from, best_to);
  return true;
}

/// What lies behind an anchor is seen in its direction.
SiteVector SiteMaps::vector_of(const Place& place) const {
  if (place.found_by == k_straight || place.found_by == k_center) return {place.at, place.distance};
  const Vec2 towards = place.anchor == k_none ? place.at : Vec2(vector_of(places_[place.anchor]).log);
  double length = place.distance;
  if (is_smooth()) {
    const double in_plane = anchor_distance(place) + place.at.norm();
    if (std::abs(in_plane - length) <= slack_ * length) length = in_plane;
  }
  return {length * towards.normalized(), length};
}

bool SiteMaps::find(Index site, Index node, Scratch& scratch, SiteVector& vector) const {
  if (label_[node] == site) {
    vector = vector_of(places_[node]);
    return true;
  }
  if (node == fans_[site].center) {  // two sites on one vertex
    vector = {};
    return true;
  }
  if (scratch.site == site) {
    const Scratch::Known known = scratch.table[node];
    if (known.round == scratch.round && known.at < 0) {
      vector = scratch.answers[~known.at].vector;
      return scratch.answers[~known.at].found;
    }
  }
  if (const Index seen = find_seen(site, node, scratch); seen != k_none) {
    const PackedVec2& place = fans_[site].places[seen];
    vector = {place, place.norm()};
    return true;
  }
  const bool found = place_near(node, site, scratch, vector);
  if (scratch.site == site) {
    scratch.table[node] = {scratch.round, ~static_cast<Index>(scratch.answers.size())};
    scratch.answers.push_back({found, vector});
  }
  return found;
}

/// A node that is not seen from the site.
bool SiteMaps::place_near(Index node, Index site, Scratch& scratch, SiteVector& vector) const {
  if (in_own_face(node, site, vector)) return true;
  Place place;
  if (!place_by_cell(node, site, scratch, place)) return false;
  vector = vector_of(place);
  return true;
}

/// Next to vertices of the site's own cell, if it has any.
bool SiteMaps::place_by_cell(Index node, Index site, Scratch& scratch, Place& place) const {
  if (first_node_[site] == first_node_[site + 1]) return false;
  const bool is_seen = beside_own(node, site, scratch, place) || place_beside(node, site, &scratch, place);
  const double straight = is_seen ? place.distance : k_infinity;
  if (!place_by_arc(node, site, scratch, is_seen, place)) return straight < k_infinity;
  place.distance = std::min(place.distance, straight);
  return true;
}

/// The corners of its face a site sees straight, even where its fan leaves them out.
bool SiteMaps::in_own_face(Index node, Index site, SiteVector& vector) const {
  if (fans_[site].center != k_none) return false;
  const auto& corners = fans_[site].corners;
  const auto corner = std::ranges::find(corners, node);
  if (corner == corners.end()) return false;
  const FaceChart chart(mesh_, sites_[site].face);
  vector.log = chart.corner[corner - corners.begin()] - chart.to_plane(sites_[site].barycentric);
  vector.distance = vector.log.norm();
  return true;
}

std::optional<PackedVec2> SiteMaps::seen_beyond(Index halfedge, const PackedVec2& from, const PackedVec2& to) const {
  if (!is_smooth() && !fits(from, to, mesh_.length(halfedge))) return {};
  const Vec2 along = (to - from).normalized();
  const Vec2& apex = graph_.unfolding().apex(halfedge);
  const Vec2 place = from + apex.x() * along + apex.y() * Vec2(-along.y(), along.x());
  const bool crosses = cross(Vec2(to), Vec2(from)) > 0 && cross(Vec2(to), place) >= 0 && cross(place, Vec2(from)) >= 0;
  return crosses || is_smooth() ? std::optional<PackedVec2>(place) : std::nullopt;
}

/// Gives a place the length of the shortest way over a graph neighbor that the site owns or, where it owns hardly one,
/// sees, and, unless it has one, the direction of that way. False where there is none.
bool SiteMaps::place_by_arc(Index node, Index site, Scratch& scratch, bool has_direction, Place& place) const {
  constexpr int k_enough = 2;
  const ArcRows& arcs = graph_.arcs();
  double shortest = k_infinity;
  Index before = k_none, seen_before = k_none;
  int count = 0;
  for (std::int64_t arc = arcs.first(node); arc < arcs.first(node + 1); ++arc) {
    const Index other = arcs.target(arc);
    if (label_[other] != site) continue;
    ++count;
    const double distance = places_[other].distance + arcs.length(arc);
    if (distance < shortest) shortest = distance, before = other;
  }
  for (std::int64_t arc = arcs.first(node); count < k_enough && arc < arcs.first(node + 1); ++arc) {
    const Index seen = find_seen(site, arcs.target(arc), scratch);
    if (seen == k_none) continue;
    const double distance = fans_[site].places[seen].norm() + arcs.length(arc);
    if (distance < shortest) shortest = distance, seen_before = seen;
  }
  if (shortest == k_infinity) return false;
  if (!has_direction)
    place = before != k_none ? place_after(node, before, scratch) : place_after_seen(node, site, seen_before, scratch);
  place.distance = shortest;
  if (lies_flat(node, site, place, count >= k_enough ? nullptr : &scratch))
    place.distance = anchor_distance(place) + place.at.norm();
  return true;
}

/// Where a way over a node that the site sees leads, straight from the site unless it bends there for good.
SiteMaps::Place SiteMaps::place_after_seen(Index node, Index site, Index seen, Scratch& scratch) const {
  const Index before = fans_[site].nodes[seen];
  const Place at_seen = place_straight(fans_[site].places[seen]);
  const Place place = place_after(node, before, at_seen, direction_back_to(site, seen), scratch);
  return place.anchor == before ? at_seen : place;
}

/// Whether the arcs from all of the site's nodes, and with scratch from those that it sees, end where the node was
/// placed: then nothing there bends the surface.
bool SiteMaps::lies_flat(Index node, Index site, const Place& place, const Scratch* scratch) const {
  const ArcRows& arcs = graph_.arcs();
  int count = 0;
  for (std::int64_t arc = arcs.first(node); arc < arcs.first(node + 1); ++arc) {
    const Index other = arcs.target(arc);
    Vec2 at;
    if (label_[other] == site) {
      at = places_[other].at;
      if (places_[other].anchor != place.anchor) return false;
      if (!is_straight(at, places_[other].distance - anchor_distance(place))) return false;
    } else {
      const Index seen = scratch && place.anchor == k_none ? find_seen(site, other, *scratch) : k_none;
      if (seen == k_none) continue;
      at = fans_[site].places[seen];
    }
    const double length = arcs.length(arc);
    if (std::abs((place.at - at).norm() - length) > k_arc_rounding * length) return false;
    ++count;
  }
  return count > 1;
}

}  // namespace saddleback
