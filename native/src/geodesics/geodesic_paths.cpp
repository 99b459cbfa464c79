// A path is a chain of arcs from a distance field's predecessors; each arc is unfolded from the vertex where it leaves.

#include "saddleback/geodesics/geodesic_paths.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saddleback/error.h"
#include "saddleback/mesh/surface_curve.h"

#include "geodesics/graph/visible_vertices.h"
#include "geodesics/queries/graph_search.h"
#include "geodesics/queries/joined_paths.h"
#include "geodesics/queries/point_targets.h"
#include "geodesics/queries/query_cache.h"
#include "geodesics/unfolding/chain_points.h"
#include "geodesics/unfolding/line_of_sight.h"
#include "geodesics/unfolding/path_shortening.h"
#include "support/threads/parallel.h"
#include "support/work_done.h"

namespace saddleback {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
// An arc's stored length is rounded to this; a looser search follows for graphs that round more.
constexpr double k_rounding = 2e-9;
// The relative error of lengths laid out beyond an edge that is 10^12 times shorter.
constexpr double k_behind_short_edges = 1e-3;
// Direction and length of an end's own arc are known to rounding.
constexpr double k_angle_margin = 1e-7;

/// Distances from the sources and how they came about.
struct PathField {
  const SurfacePoints& sources;
  DirectFans fans;                   ///< of the sources
  std::vector<PointFan> point_fans;  ///< the same
  LabelField labels;
};

PathField make_field(const SaddleVertexGraph& graph, const SurfacePoints& sources, double limit, int threads,
                     const JobStage& stage) {
  PathField field{sources, {}, {}, {}};
  const double cost = cost_of_fans(graph, sources), share = cost / (cost + graph.mesh().vertex_count());
  field.fans = direct_fans(graph, sources, threads, stage.part(0, share));
  for (std::size_t i = 0; i < sources.size(); ++i)
    field.point_fans.push_back(point_fan(graph, sources[i], field.fans[i]));
  field.labels = propagate_labels(graph, seeds_of(field.point_fans), {.limit = limit}, true, stage.part(share, 1));
  return field;
}

/// No shortest path is longer: the straight way between two points in sight of each other, so that near points are
/// joined without a field of the whole mesh.
double longest_path(const SaddleVertexGraph& graph, const SurfacePoints& sources, const SurfacePoints& targets,
                    const JobStage& stage) {
  if (sources.size() != 1 || targets.size() != 1) return k_infinity;
  const std::vector<PointFan> fans = find_fans(graph, {sources[0], targets[0]}, stage, {.threads = 1});
  return direct_length(graph, sources[0], fans[0], targets[0], fans[1]);
}

/// Holds where a path to a target ends: after the last vertex, none when it comes straight from the source.
struct Arrival {
  double distance = k_infinity;
  Index source = k_none;
  const DirectArc* arc = nullptr;  ///< of the target's fan
  Index vertex = k_none;
};

class PathMaker {
 public:
  PathMaker(const SaddleVertexGraph& graph, const PathField& field, const NearbySources& nearby, bool shorten,
            const JobStage& stage)
      : graph_(graph),
        mesh_(graph.mesh()),
        field_(field),
        nearby_(nearby),
        stage_(stage),
        shorten_(shorten),
        sight_(graph.is_exact()),
        unfolder_(graph.unfolding(), shorten),
        shortener_(graph.unfolding()) {}

  /// Appends the path to the target, without any points when nothing reaches it.
  void append(const SurfacePoint& target, std::span<const DirectArc> fan, GeodesicPaths& paths) {
    const Arrival arrival = arrive(target, fan);
    double length = k_infinity;
    if (arrival.source != k_none) {
      make_chain(target, arrival);
      if (shorten_) shortener_.shorten(chain_);
      length = chain_.length();
      append_points(mesh_, chain_, paths.points, paths.surface);
    }
    paths.offsets.push_back(static_cast<std::int64_t>(paths.points.size()));
    paths.lengths.push_back(length);
    paths.sources.push_back(arrival.source);
  }

 private:
  Arrival arrive(const SurfacePoint& target, std::span<const DirectArc> fan) const {
    Arrival best;
    if (const Index vertex = vertex_at(mesh_, target); vertex != k_none) {
      return {field_.labels.distance[vertex], field_.labels.source[vertex], nullptr, vertex};
    }
    for (const DirectArc& arc : fan) {
      const double distance = field_.labels.distance[arc.vertex] + graph_.arcs().codec().round(arc.length);
      if (distance < best.distance) best = {distance, field_.labels.source[arc.vertex], &arc, arc.vertex};
    }
    Index seen = k_none;
    const double direct = nearby_.least_length(target, point_fan(graph_, target, fan), best.distance, stage_, &seen);
    if (seen != k_none) best = {direct, seen, nullptr, k_none};
    return best;
  }

  void make_chain(const SurfacePoint& target, const Arrival& arrival) {
    chain_.clear();
    const SurfacePoint& source = field_.sources[arrival.source];
    vertices_.clear();
    for (Index v = arrival.vertex; v != k_none; v = field_.labels.predecessor[v]) vertices_.push_back(v);
    std::reverse(vertices_.begin(), vertices_.end());
    if (vertices_.empty()) {  // in sight
      chain_.ends = {leg_end(mesh_, source), leg_end(mesh_, target)};
      sight_.length(graph_.unfolding(), source, target, std::nextafter(arrival.distance, k_infinity));
      lay_out(graph_.unfolding(), chain_.ends[0], chain_.ends[1], sight_.entered(), chain_.add_leg());
      return;
    }
    if (vertex_at(mesh_, source) == k_none) add_source_leg(arrival.source, source);
    chain_.ends.push_back(leg_end(mesh_, vertices_[0]));
    for (std::size_t i = 1; i < vertices_.size(); ++i) {
      add_arc(vertices_[i - 1], vertices_[i]);
      chain_.ends.push_back(leg_end(mesh_, vertices_[i]));
    }
    if (arrival.arc) {
      unfold_to(*arrival.arc, target, chain_.add_leg());
      chain_.ends.push_back(leg_end(mesh_, target));
    }
  }

  void add_source_leg(Index index, const SurfacePoint& source) {
    const std::span<const DirectArc> fan = field_.fans[index];
    const auto arc = std::ranges::find_if(fan, [&](const DirectArc& a) { return a.vertex == vertices_[0]; });
    chain_.ends.push_back(leg_end(mesh_, source));
    UnfoldedArc& leg = chain_.add_leg();
    unfold_to(*arc, source, leg);
    reverse(mesh_, leg);
  }

  void add_arc(Index from, Index to) {
    const Index node = graph_.node_of(from);
    const std::int64_t arc = graph_.arcs().find(node, graph_.node_of(to));
    ArcHint hint = graph_.hint(node, arc);
    UnfoldedArc& leg = chain_.add_leg();
    const double loose = hint.tolerance;
    hint.tolerance = k_rounding;
    if (unfolder_.unfold(hint, leg)) return;
    hint.tolerance = loose;
    if (unfolder_.unfold(hint, leg)) return;
    hint.is_rough = true;
    hint.tolerance = std::max(loose, k_behind_short_edges);
    hint.begin_angle = 0;
    hint.end_angle = mesh_.total_angle(from);
    if (!unfolder_.unfold(hint, leg)) {
      throw Error(message("the arc from vertex ", from, " to vertex ", to, " is not one of this mesh"));
    }
  }

  /// Unfolds from the vertex of an arc back to the point that it leaves.
  void unfold_to(const DirectArc& arc, const SurfacePoint& point, UnfoldedArc& leg) {
    ArcHint hint{arc.vertex, k_none, arc.length, arc.end_angle - k_angle_margin, arc.end_angle + k_angle_margin,
                 k_rounding};
    if (unfolder_.unfold(hint, point, leg)) return;
    // Directions about 0 are also those about the total angle.
    const double total = mesh_.total_angle(arc.vertex), turn = arc.end_angle > total / 2 ? -total : total;
    hint.begin_angle += turn;
    hint.end_angle += turn;
    if (unfolder_.unfold(hint, point, leg)) return;
    hint = {arc.vertex, k_none, arc.length, 0, total};
    if (!unfolder_.unfold(hint, point, leg)) {
      throw Error(message("the way from vertex ", arc.vertex, " to a point of face ", point.face, " was not found"));
    }
  }

  const SaddleVertexGraph& graph_;
  const Mesh& mesh_;
  const PathField& field_;
  const NearbySources& nearby_;
  const JobStage& stage_;
  const bool shorten_;
  LineOfSight sight_;
  ArcUnfolder unfolder_;
  PathShortener shortener_;
  std::vector<Index> vertices_;
  LegChain chain_;
};

}  // namespace

GeodesicPath GeodesicPaths::path(std::size_t i) const {
  const auto from = static_cast<std::ptrdiff_t>(offsets[i]), to = static_cast<std::ptrdiff_t>(offsets[i + 1]);
  return {{points.begin() + from, points.begin() + to}, {surface.begin() + from, surface.begin() + to}, lengths[i]};
}

GeodesicPath shortest_path(const SaddleVertexGraph& graph, const SurfacePoint& a, const SurfacePoint& b,
                           const PathOptions& options, Job* job) {
  const Mesh& mesh = graph.mesh();
  check_surface_point(mesh, a, "a");
  check_surface_point(mesh, b, "b");
  const auto component = [&](const SurfacePoint& p) { return mesh.component_of(mesh.triangles()[p.face][0]); };
  if (component(a) != component(b)) {
    throw InputError(message("b: no path leads there, a is on component ", component(a), " and b on component ",
                             component(b), " of the mesh"));
  }
  return shortest_paths(graph, {a}, {b}, options, job).path(0);
}

GeodesicPaths shortest_paths(const SaddleVertexGraph& graph, const SurfacePoints& sources, const SurfacePoints& targets,
                             const PathOptions& options, Job* job) {
  if (sources.empty()) throw InputError("sources: wanted at least one source, got none");
  check_surface_points(graph.mesh(), sources, "sources");
  check_surface_points(graph.mesh(), targets, "targets");
  if (options.threads < 0) throw InputError(message("threads: wanted 0 (all) or more, got ", options.threads));
  const JobStage stage(job, "Finding paths");
  // The cost of a path, in nodes that the search of a field expands in the same time.
  constexpr double k_cost_of_path = 100;
  const double field_cost = cost_of_fans(graph, sources) + graph.mesh().vertex_count(),
               target_cost = cost_of_fans(graph, targets) + k_cost_of_path * static_cast<double>(targets.size()),
               with_field = field_cost / (field_cost + target_cost);
  const PathField field = make_field(graph, sources, longest_path(graph, sources, targets, stage.part(0, 0)),
                                     options.threads, stage.part(0, with_field));
  constexpr Index k_block = 32;
  const auto count = static_cast<Index>(targets.size());
  const Index blocks = (count + k_block - 1) / k_block;
  JoinedPaths paths(blocks);
  std::vector<GeodesicPaths> parts(thread_count(options.threads));
  std::vector<std::unique_ptr<PathMaker>> makers(parts.size());
  std::vector<DirectFans> fans(parts.size());
  FanTeam team(graph, targets, options.threads, stage.part(with_field, with_field));
  const bool any_inside = std::ranges::any_of(
      targets, [&](const SurfacePoint& target) { return vertex_at(graph.mesh(), target) == k_none; });
  const SurfacePoints no_sources;  // vertices are reached by the field alone
  const NearbySources nearby(graph, any_inside ? sources : no_sources,
                             any_inside ? std::span<const PointFan>(field.point_fans) : std::span<const PointFan>());
  WorkDone done(stage.part(with_field, 1), count);
  parallel_for(blocks, options.threads, 1, [&](Index block, int thread) {
    if (!makers[thread]) makers[thread] = std::make_unique<PathMaker>(graph, field, nearby, options.shorten, stage);
    const Index first = block * k_block;
    const std::span own = std::span(targets).subspan(first, std::min(k_block, count - first));
    fans[thread].clear();
    team[thread].find(graph, own, {}, FanAngles::both, fans[thread], stage);
    for (std::size_t i = 0; i < own.size(); ++i) {
      makers[thread]->append(own[i], fans[thread][i], parts[thread]);
      done.add(1);
    }
    paths.add(block, static_cast<double>(own.size()) / count, parts[thread]);
  });
  stage.update(1);
  return paths.take();
}

}  // namespace saddleback
