// Method: labels by shortest paths in the graph; then each vertex is placed in the plane of its site, after the vertex
// before it on its path. A vertex next to another site's cell is placed there through a neighbour in the graph which
// that site owns: the last bit of the path leaves the cell, all before lies inside (cells are star-shaped).

#include "tessellation/site_maps.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "geodesics/label_propagation.h"
#include "support/parallel.h"

namespace saddleback {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();

Vec2 polar(double length, double angle) { return {length * std::cos(angle), length * std::sin(angle)}; }

/// By how much a path that comes from direction `back` and goes on in direction `out` turns (left positive) when
/// developed.
double turn_at(const Mesh& mesh, Index vertex, double back, double out) {
  if (mesh.is_boundary(vertex)) {  // only one side of the path is surface
    return out >= back ? std::min(out - back - M_PI, 0.0) : std::max(M_PI - (back - out), 0.0);
  }
  const double total = mesh.total_angle(vertex);
  const double left_side = out >= back ? out - back : out - back + total;  // counter-clockwise from back to out
  if (total <= 2 * M_PI) return left_side - total / 2;
  if (left_side < M_PI) return left_side - M_PI;
  if (total - left_side < M_PI) return M_PI - (total - left_side);
  return 0;
}

void sort_by_vertex(std::vector<DirectArc>& arcs) {
  std::sort(arcs.begin(), arcs.end(), [](const DirectArc& a, const DirectArc& b) { return a.vertex < b.vertex; });
}

}  // namespace

SiteMaps::SiteMaps(const SaddleVertexGraph& graph, const SurfacePoints& sites, int threads, const JobStage& stage)
    : graph_(graph),
      mesh_(graph.mesh()),
      unfolder_(graph.unfolding()),
      fans_(sites.size()),
      places_(graph.mesh().vertex_count()),
      first_known_(graph.mesh().vertex_count(), k_none) {
  std::vector<std::unique_ptr<WindowPropagator>> propagators(thread_count(threads));
  parallel_for(static_cast<Index>(sites.size()), threads, 4, [&](Index site, int thread) {
    stage.check();
    if (!propagators[thread]) propagators[thread] = std::make_unique<WindowPropagator>(graph.unfolding());
    make_fan(site, sites[site], *propagators[thread]);
  });
  stage.update(0.3);
  std::vector<Index> predecessor;
  label_vertices(stage, predecessor);
  stage.update(0.8);
  develop(predecessor, stage);
  stage.update(1);
}

void SiteMaps::make_fan(Index site, const SurfacePoint& point, WindowPropagator& propagator) {
  Fan& fan = fans_[site];
  fan.centre = vertex_at(mesh_, point);
  if (fan.centre != k_none) return make_fan_at_vertex(fan);
  graph_.fan(point, propagator, fan.arcs);
  for (DirectArc& arc : fan.arcs) arc.length = graph_.arcs().codec().round(arc.length);
  sort_by_vertex(fan.arcs);
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

void SiteMaps::label_vertices(const JobStage& stage, std::vector<Index>& predecessor) {
  std::vector<Seed> seeds;
  for (Index site = 0; site < static_cast<Index>(fans_.size()); ++site) {
    const Fan& fan = fans_[site];
    if (fan.centre != k_none) seeds.push_back({fan.centre, site, 0});
    for (const DirectArc& arc : fan.arcs) seeds.push_back({arc.vertex, site, arc.length});
  }
  LabelField field = propagate_labels(graph_, seeds, {}, true, stage.part(0.3, 0.8));
  label_ = std::move(field.source);
  distance_ = std::move(field.distance);
  predecessor = std::move(field.predecessor);
}

void SiteMaps::develop(const std::vector<Index>& predecessor, const JobStage& stage) {
  std::vector<std::uint8_t> placed(label_.size(), 0);
  std::vector<Index> chain;
  for (Index v = 0; v < mesh_.vertex_count(); ++v) {
    if (v % 1024 == 0) stage.check();
    if (label_[v] == k_none) continue;
    for (Index u = v; u != k_none && !placed[u]; u = predecessor[u]) chain.push_back(u);
    for (; !chain.empty(); chain.pop_back()) {
      const Index u = chain.back();
      const Fan& fan = fans_[label_[u]];
      placed[u] = 1;
      if (u == fan.centre) continue;
      // A vertex just after a site's own vertex is reached by an arc of the fan, too: same arc, scaled angle.
      const bool direct = predecessor[u] == k_none || predecessor[u] == fan.centre;
      places_[u] = direct ? place_direct(*fan_arc(label_[u], u)) : place_after(u, predecessor[u]);
    }
  }
}

const DirectArc* SiteMaps::fan_arc(Index site, Index vertex) const {
  const auto& arcs = fans_[site].arcs;
  const auto found = std::lower_bound(arcs.begin(), arcs.end(), vertex,
                                      [](const DirectArc& arc, Index wanted) { return arc.vertex < wanted; });
  return found != arcs.end() && found->vertex == vertex ? &*found : nullptr;
}

SiteMaps::Place SiteMaps::place_direct(const DirectArc& arc) const {
  return {polar(arc.length, arc.start_angle), arc.start_angle, arc.end_angle};
}

SiteMaps::Place SiteMaps::place_after(Index vertex, Index previous) {
  const Place& before = places_[previous];
  const Index node = graph_.node_of(previous);
  const std::int64_t arc = graph_.arcs().find(node, graph_.node_of(vertex));
  unfolder_.unfold(graph_.hint(node, arc), unfolded_);
  const double heading = before.heading + turn_at(mesh_, previous, before.back, unfolded_.start_angle);
  return {before.log + polar(graph_.arcs().length(arc), heading), heading, unfolded_.end_angle};
}

Vec2 SiteMaps::log(Index vertex, Index site, Index halfedge) {
  if (label_[vertex] == site) return places_[vertex].log;
  if (const Known* known = find_known(vertex, site)) return known->log;
  Vec2 result;
  if (!pull(vertex, site, result)) result = lay_beside(halfedge, site);
  known_.push_back({result, site, first_known_[vertex]});
  first_known_[vertex] = static_cast<Index>(known_.size()) - 1;
  return result;
}

Vec2 SiteMaps::known_log(Index vertex, Index site) const {
  return label_[vertex] == site ? places_[vertex].log : find_known(vertex, site)->log;
}

const SiteMaps::Known* SiteMaps::find_known(Index vertex, Index site) const {
  for (Index i = first_known_[vertex]; i != k_none; i = known_[i].next) {
    if (known_[i].site == site) return &known_[i];
  }
  return nullptr;
}

/// Places the vertex by the site's own fan or by the nearest way over a graph neighbour that the site owns.
bool SiteMaps::pull(Index vertex, Index site, Vec2& log) {
  if (vertex == fans_[site].centre) {  // two sites on one vertex
    log = Vec2::Zero();
    return true;
  }
  double best = k_infinity;
  Index through = k_none;
  const DirectArc* direct = fan_arc(site, vertex);
  if (direct) best = direct->length;
  const ArcRows& arcs = graph_.arcs();
  const Index node = graph_.node_of(vertex);
  for (std::int64_t arc = arcs.first(node); arc < arcs.first(node + 1); ++arc) {
    const Index neighbour = graph_.vertex_of(arcs.target(arc));
    if (label_[neighbour] != site || distance_[neighbour] + arcs.length(arc) >= best) continue;
    best = distance_[neighbour] + arcs.length(arc);
    through = neighbour;
  }
  if (best == k_infinity) return false;
  log =
      through == k_none || through == fans_[site].centre ? place_direct(*direct).log : place_after(vertex, through).log;
  return true;
}

/// Lays the face of the half-edge down in the site's plane, on the side of the edge where it lies on the surface.
Vec2 SiteMaps::lay_beside(Index halfedge, Index site) const {
  const Vec2 from = known_log(mesh_.from(halfedge), site), to = known_log(mesh_.to(halfedge), site);
  Vec2 along = to - from;
  along = along.norm() > 0 ? along.normalized() : Vec2(1, 0);
  const Vec2 apex = graph_.unfolding().apex(halfedge);
  return from + apex.x() * along + apex.y() * Vec2(-along.y(), along.x());
}

}  // namespace saddleback
