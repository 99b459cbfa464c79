#include "tessellation/log_map/seen_vertices.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geodesics/graph/arc_rows.h"
#include "geodesics/unfolding/arc_unfolding.h"
#include "support/threads/parallel.h"
#include "tessellation/log_map/edge_sight.h"

namespace saddleback {

void SeenVertices::resize(std::size_t count) {
  nodes.resize(count);
  rounded.resize(count);
  places.resize(count);
  across.resize(count);
}

void SeenVertices::set(std::size_t i, const SeenNode& node, double length_rounded) {
  nodes[i] = node.node;
  rounded[i] = length_rounded;
  places[i] = node.place;
  across[i] = {node.from, node.edge};
}

void SeenVertices::set_arcs(std::ptrdiff_t count) {
  arc_count = static_cast<std::size_t>(count);
  first = count == 0 ? 0 : *std::min_element(nodes.begin(), nodes.begin() + count);
  last = count == 0 ? -1 : *std::max_element(nodes.begin(), nodes.begin() + count);
}

Index SeenVertices::find(Index node) const {
  const auto found = std::ranges::find(nodes, node);
  return found != nodes.end() ? static_cast<Index>(found - nodes.begin()) : k_none;
}

void SeenFromSites::find(const Request& request, int threads, const JobStage& stage) {
  // Sites are asked for so much more than they reach, that they may reach farther; beside cells that stay they may soon
  // reach much farther.
  constexpr double k_growth = 1.1, k_growth_of_few = 1.6;
  const SurfacePoints& sites = request.sites;
  if (!request.keeps_any) {
    seen_.resize(sites.size());
    limits_.resize(sites.size());
  }
  parallel_for(static_cast<Index>(sites.size()), threads, 256, [&](Index i, int) {
    const Index site = request.order[i];
    if (request.is_kept[site] != 0) return;
    const Index vertex = vertex_at(graph_.mesh(), sites[site]);
    seen_[site].center = vertex == k_none ? k_none : graph_.node_of(vertex);
    seen_[site].corners = rings_.face(rings_.face_of(sites[site].face)).nodes;
    limits_[site] = request.reaches.empty() ? std::numeric_limits<double>::infinity()
                                            : (request.keeps_any ? k_growth_of_few : k_growth) * request.reaches[site];
  });
  std::vector<Index> at_vertices, inside;
  SurfacePoints points;
  std::vector<double> limits;
  for (const Index site : request.order) {
    if (request.is_kept[site] != 0) continue;
    if (seen_[site].center != k_none) {
      at_vertices.push_back(site);
      continue;
    }
    inside.push_back(site);
    points.push_back(sites[site]);
    if (!request.reaches.empty()) limits.push_back(limits_[site]);
  }
  const ArcCodec& codec = graph_.arcs().codec();
  for_each_view(graph_, points, limits, threads, stage, [&](Index i, const SeenView& view) {
    SeenVertices& seen = seen_[inside[i]];
    seen.resize(view.size());
    view.visit([&](std::size_t k, const SeenNode& node) { seen.set(k, node, codec.round(node.length)); });
    seen.set_arcs(static_cast<std::ptrdiff_t>(view.arc_count()));
  });
  parallel_for(static_cast<Index>(at_vertices.size()), threads, 16, [&](Index i, int) {
    stage.check();
    find_from_vertex(seen_[at_vertices[i]]);
  });
}

void SeenFromSites::find_from_vertex(SeenVertices& seen) const {
  const Mesh& mesh = graph_.mesh();
  const Index node = seen.center, vertex = graph_.vertex_of(node);
  const double scale = mesh.is_boundary(vertex) ? 1 : 2 * std::numbers::pi / mesh.total_angle(vertex);
  const ArcRows& arcs = graph_.arcs();
  ArcUnfolder unfolder(graph_.unfolding());
  UnfoldedArc unfolded;
  const std::int64_t begin = arcs.first(node), count = arcs.first(node + 1) - begin;
  seen.resize(static_cast<std::size_t>(count));
  arcs.look_at(node);
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t arc = begin + i;
    const double rounded = arcs.length(arc);
    const double length = unfolder.unfold(graph_.hint(node, arc), unfolded) ? unfolded.length : rounded;
    const Vec2 place = polar(length, scale * unfolded.start_angle);
    seen.set(static_cast<std::size_t>(i), {arcs.target(arc), k_none, true, length, place, Vec2(unfolded.end_angle, 0)},
             rounded);
  }
  seen.set_arcs(count);
}

void SeenFromSites::renumber(std::span<const Index> before) {
  std::vector<SeenVertices> seen(before.size());
  std::vector<double> limits(before.size(), 0);
  for (std::size_t site = 0; site < before.size(); ++site) {
    if (before[site] == k_none) continue;
    seen[site] = std::move(seen_[before[site]]);
    limits[site] = limits_[before[site]];
  }
  seen_.swap(seen);
  limits_.swap(limits);
}

double SeenFromSites::direction_back(Index site, Index seen) const {
  const SeenVertices& all = seen_[site];
  const auto& [from, edge] = all.across[seen];
  return saddleback::direction_back(graph_,
                                    {all.nodes[seen], edge, true, all.places[seen].norm(), all.places[seen], from});
}

void SeenFromSites::fetch(Index site) const {
  constexpr std::size_t k_fetched = 48, k_line = 64;
  const SeenVertices& seen = seen_[site];
  const std::size_t count = std::min(seen.nodes.size(), k_fetched);
  for (std::size_t i = 0; i < count; i += k_line / sizeof(Index)) __builtin_prefetch(&seen.nodes[i]);
  for (std::size_t i = 0; i < count; i += k_line / sizeof(double)) __builtin_prefetch(&seen.rounded[i]);
  for (std::size_t i = 0; i < count; i += k_line / sizeof(PackedVec2)) __builtin_prefetch(&seen.places[i]);
}

}  // namespace saddleback
