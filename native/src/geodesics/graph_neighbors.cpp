#include "saddleback/geodesics/graph_neighbors.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "saddleback/error.h"

#include "geodesics/graph/arc_rows.h"
#include "geodesics/unfolding/arc_unfolding.h"

namespace saddleback {
namespace {

constexpr Index k_rows_between_looks = 1024;

/// Lists a vertex's arcs by target.
void list_row(const SaddleVertexGraph& graph, Index vertex, std::vector<std::pair<Index, std::int64_t>>& row) {
  const ArcRows& arcs = graph.arcs();
  const Index node = graph.node_of(vertex);
  arcs.look_at(node);
  row.clear();
  for (std::int64_t arc = arcs.first(node); arc < arcs.first(node + 1); ++arc)
    row.emplace_back(graph.vertex_of(arcs.target(arc)), arc);
  std::ranges::sort(row);
}

}  // namespace

GraphArcs graph_arcs(const SaddleVertexGraph& graph, Job* job) {
  const JobStage stage(job, "listing arcs");
  const Index count = graph.mesh().vertex_count();
  const auto size = static_cast<std::size_t>(graph.arc_count());
  GraphArcs found;
  found.offsets.assign(1, 0);
  found.targets.reserve(size);
  found.lengths.reserve(size);
  std::vector<std::pair<Index, std::int64_t>> row;
  for (Index v = 0; v < count; ++v) {
    if (v % k_rows_between_looks == 0) stage.update(static_cast<double>(v) / count);
    list_row(graph, v, row);
    for (const auto& [target, arc] : row) {
      found.targets.push_back(target);
      found.lengths.push_back(graph.arcs().length(arc));
    }
    found.offsets.push_back(static_cast<std::int64_t>(found.targets.size()));
  }
  stage.update(1);
  return found;
}

GraphNeighbors graph_neighbors(const SaddleVertexGraph& graph, Index vertex) {
  if (vertex < 0 || vertex >= graph.mesh().vertex_count())
    throw InputError(message("vertex: wanted 0 to ", graph.mesh().vertex_count() - 1, ", got ", vertex));
  std::vector<std::pair<Index, std::int64_t>> row;
  list_row(graph, vertex, row);
  ArcUnfolder unfolder(graph.unfolding());
  UnfoldedArc unfolded;
  GraphNeighbors found;
  for (const auto& [target, arc] : row) {
    const ArcHint hint = graph.hint(graph.node_of(vertex), arc);
    // Where rounding hides the geodesic, the sector that is kept of its direction is what is known.
    const bool is_found = unfolder.unfold(hint, unfolded);
    found.vertices.push_back(target);
    found.lengths.push_back(hint.length);
    found.angles.push_back(is_found ? unfolded.start_angle : (hint.begin_angle + hint.end_angle) / 2);
  }
  return found;
}

std::vector<std::int8_t> vertex_kinds(const Mesh& mesh) {
  constexpr double k_flat = 2 * std::numbers::pi * (1 - 1e-10);  // as far below a full turn as saddles are above it
  std::vector<std::int8_t> kinds;
  kinds.reserve(static_cast<std::size_t>(mesh.vertex_count()));
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    kinds.push_back(static_cast<std::int8_t>(mesh.is_saddle(v) ? -1 : mesh.total_angle(v) < k_flat));
  return kinds;
}

ArcTiers arc_tiers(const SaddleVertexGraph& graph) {
  const ArcRows& arcs = graph.arcs();
  arcs.look_at_all();
  std::int64_t saddle_ends[3] = {};
  for (Index node = 0; node < arcs.node_count(); ++node) {
    const int here = graph.mesh().is_saddle(graph.vertex_of(node));
    for (std::int64_t arc = arcs.first(node); arc < arcs.first(node + 1); ++arc)
      if (arcs.target(arc) > node) ++saddle_ends[here + graph.mesh().is_saddle(graph.vertex_of(arcs.target(arc)))];
  }
  return {saddle_ends[2], saddle_ends[1], saddle_ends[0]};
}

}  // namespace saddleback
