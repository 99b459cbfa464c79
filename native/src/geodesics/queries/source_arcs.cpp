#include "geodesics/queries/source_arcs.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>

#include "geodesics/queries/query_cache.h"
#include "support/planar.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

// Width of the strip along a curve, in edges, for each arc that a vertex has on average. What lies behind the strip is
// seen from the vertex in it whose ray passes nearest, by a detour the smaller the more vertices there are: twice the
// strip leaves the mean error as it is.
constexpr double k_edges_an_arc = 0.15;
// That vertex is within half an edge of the way, which is longer by it by an eighth of an edge over the width at most,
// relatively by an eighth over the width's square: the share of the accuracy that a strip may take.
constexpr double k_share_of_accuracy = 0.25;
// Nodes that a search expands while a fan is found: of a point by waves and one by one, of a curve.
constexpr double k_cost_of_point = 28, k_cost_of_exact_point = 1500, k_cost_of_strip_vertex = 30;
constexpr double k_vertices_a_segment = 1;  ///< at least so many take as long, also where a curve runs along itself

/// Returns the width in edges; of an exact graph distances from curves are exact.
double strip_width(const SaddleVertexGraph& graph) {
  if (graph.is_exact()) return std::numeric_limits<double>::infinity();
  const double accuracy = graph.accuracy();
  return std::max(k_edges_an_arc * graph.mean_degree(),
                  accuracy > 0 ? 1 / std::sqrt(8 * k_share_of_accuracy * accuracy) : 0);
}

/// Returns, of a curve's faces, the share that it has not been in before: where it runs along itself windows are few.
double share_of_new_faces(const SurfaceCurve& curve) {
  std::vector<Index> faces;
  for (const CurveSegment& segment : curve.segments()) faces.push_back(segment.face);
  std::ranges::sort(faces);
  const auto repeated = std::ranges::unique(faces);
  return 1 - static_cast<double>(std::ssize(repeated)) / std::max(1.0, static_cast<double>(faces.size()));
}

/// The corners of the faces that a curve passes, by the straight line inside the face.
void add_corners(const SurfaceCurve& curve, std::vector<PointFan::Arc>& arcs) {
  const Mesh& mesh = curve.mesh();
  for (const CurveSegment& segment : curve.segments()) {
    const FaceChart chart(mesh, segment.face);
    const Vec2 begin = chart.to_plane(segment.begin), end = chart.to_plane(segment.end);
    for (int i = 0; i < 3; ++i)
      arcs.push_back({mesh.triangles()[segment.face][i], distance_to_segment(chart.corner[i], begin, end)});
  }
}

/// Sorts by vertex, of several arcs to one vertex the shortest.
void sort_arcs(std::vector<PointFan::Arc>& arcs) {
  std::ranges::sort(arcs, [](const PointFan::Arc& a, const PointFan::Arc& b) {
    return a.vertex != b.vertex ? a.vertex < b.vertex : a.length < b.length;
  });
  const auto rest = std::ranges::unique(arcs, {}, &PointFan::Arc::vertex);
  arcs.erase(rest.begin(), rest.end());
}

}  // namespace

PointFan CurveFanFinder::find(const SaddleVertexGraph& graph, const SurfaceCurve& curve, const FanOptions& options,
                              const JobStage& stage) {
  constexpr double k_made = 0.1, k_begun = 0.05;  // of the time
  const double made = curve_windows_ ? 0 : k_made, begun = made + k_begun;
  if (!curve_windows_) curve_windows_ = std::make_unique<CurveWindows>(graph.unfolding());
  const RayLimits limits{.radius = options.limit, .edges = strip_width(graph)};
  const JobStage running = stage.part(begun, 1);
  const Mesh& mesh = graph.mesh();
  const double width = std::min(limits.radius, limits.edges * mesh.mean_edge_length());
  curve_windows_->from_curve(curve, limits, feet_, stage.part(made, begun), options.places,
                             [&](double distance, Index reached) {
                               const double vertices = static_cast<double>(reached) / mesh.vertex_count();
                               running.update(std::max(distance / width, vertices));
                             });
  PointFan fan;
  add_corners(curve, fan.arcs);
  for (const CurveFoot& foot : feet_) fan.arcs.push_back({foot.vertex, foot.distance});
  sort_arcs(fan.arcs);
  for (PointFan::Arc& arc : fan.arcs) {
    if (arc.length > 0) arc.length = graph.arcs().codec().round(arc.length);
    fan.reach = std::max(fan.reach, arc.length);
  }
  return fan;
}

PointFan point_fan(const SaddleVertexGraph& graph, const SurfacePoint& point, std::span<const DirectArc> arcs) {
  if (const Index vertex = vertex_at(graph.mesh(), point); vertex != k_none) return {{{vertex, 0}}, 0, true};
  PointFan fan;
  fan.arcs.reserve(arcs.size());
  for (const DirectArc& arc : arcs) {
    fan.arcs.push_back({arc.vertex, graph.arcs().codec().round(arc.length)});
    fan.reach = std::max(fan.reach, arc.length);
  }
  return fan;
}

std::vector<PointFan> find_fans(const SaddleVertexGraph& graph, const SurfacePoints& points, const JobStage& stage,
                                const FanOptions& options) {
  std::vector<PointFan> fans(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    if (vertex_at(graph.mesh(), points[i]) != k_none) fans[i] = point_fan(graph, points[i], {});
  for_each_fan(graph, points, {}, FanAngles::none, options.threads, stage,
               [&](Index i, std::span<const DirectArc> arcs) { fans[i] = point_fan(graph, points[i], arcs); });
  return fans;
}

SourceFans find_fans(const SaddleVertexGraph& graph, const QuerySources& sources, const JobStage& stage,
                     const FanOptions& options) {
  const double all = cost_of_fans(graph, sources), of_points = cost_of_fans(graph, sources.points);
  const double share = all > 0 ? of_points / all : 1;
  SourceFans result{find_fans(graph, sources.points, stage.part(0, share), options), {}};
  result.fans.resize(sources.size());
  if (options.places) result.at_places.assign(options.places->size(), std::numeric_limits<double>::infinity());
  const JobStage rest = stage.part(share, 1);
  std::vector<ScratchPool<CurveFanFinder>::Lease> finders;
  if (!sources.curves.empty()) {
    const auto count = static_cast<int>(sources.curves.size());
    for (int thread = 0; thread < std::min(thread_count(options.threads), count); ++thread)
      finders.push_back(graph.query_cache().curve_fan_finders.lease());
  }
  std::atomic<std::size_t> done{0};
  std::mutex mutex;
  parallel_for(static_cast<Index>(sources.curves.size()), options.threads, 1, [&](Index i, int thread) {
    CurveFanFinder& finder = *finders[thread];
    result.fans[sources.points.size() + static_cast<std::size_t>(i)] =
        finder.find(graph, *sources.curves[i], options, sources.curves.size() == 1 ? rest : rest.part(0, 0));
    if (options.places) {
      const std::span<const double> found = finder.place_distances();
      const std::lock_guard lock(mutex);
      std::ranges::transform(result.at_places, found, result.at_places.begin(), std::ranges::min);
    }
    rest.update(static_cast<double>(done.fetch_add(1, std::memory_order_relaxed) + 1) /
                static_cast<double>(sources.curves.size()));
  });
  return result;
}

double cost_of_fans(const SaddleVertexGraph& graph, const SurfacePoints& points, FirstFans first) {
  const auto inside = std::ranges::count_if(
      points, [&](const SurfacePoint& point) { return vertex_at(graph.mesh(), point) == k_none; });
  if (graph.is_exact()) return k_cost_of_exact_point * static_cast<double>(inside);
  const double of_mesh = inside > 0 && first == FirstFans::maybe ? fans_a_fan_mesh_costs(graph) : 0;
  if (inside == 0) return 0;
  return k_cost_of_point * (static_cast<double>(inside) + of_mesh);
}

double cost_of_fans(const SaddleVertexGraph& graph, const QuerySources& sources) {
  double cost = cost_of_fans(graph, sources.points);
  for (const SurfaceCurve* const curve : sources.curves) {
    const double length = share_of_new_faces(*curve) * curve->length();
    const double strip = 2 * strip_width(graph) * length / graph.mesh().mean_edge_length();
    cost += k_cost_of_strip_vertex * std::max(std::min(strip, static_cast<double>(graph.mesh().vertex_count())),
                                              k_vertices_a_segment * static_cast<double>(curve->segments().size()));
  }
  return cost;
}

double cost_of_seeds(const SaddleVertexGraph& graph, const SurfacePoints& points) {
  return k_cost_of_seed * graph.mean_degree() * static_cast<double>(points.size());
}

std::vector<Seed> seeds_of(std::span<const PointFan> fans) {
  std::vector<Seed> seeds;
  seeds.reserve(fans.size());
  for (std::size_t i = 0; i < fans.size(); ++i) {
    for (const PointFan::Arc& arc : fans[i].arcs) seeds.push_back({arc.vertex, static_cast<Index>(i), arc.length});
  }
  return seeds;
}

}  // namespace saddleback
