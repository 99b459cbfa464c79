#include "geodesics/queries/point_arcs.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

#include "saddleback/geodesics/saddle_vertex_graph.h"

#include "geodesics/graph/graph_arcs.h"
#include "geodesics/queries/query_cache.h"
#include "support/planar.h"
#include "support/threads/parallel.h"
#include "support/work_done.h"

namespace saddleback {
namespace {

// The share of the time of one fan that the fan mesh takes for each vertex of the mesh.
constexpr double k_fan_mesh_cost = 0.07;
// Points a thread takes at a time, fewer where each has only so many chunks.
constexpr Index k_most_at_once = 8 * k_batch, k_chunks_a_thread = 4;
// In units of the source's plane: a corner nearer than this has no direction in single precision, where its square is
// as good as zero.
constexpr double k_nearest = 1e-18;

bool is_vertex(const Mesh& mesh, const SurfacePoint& point) { return vertex_at(mesh, point) != k_none; }

FaceSource face_source(const SaddleVertexGraph& graph, const WindowMesh& waves, const SurfacePoint& point) {
  const Mesh& mesh = graph.mesh();
  const FaceChart chart(mesh, point.face);
  FaceSource source;
  const Index h = 3 * point.face;
  source.scale = scale_about(std::max({mesh.length(h), mesh.length(h + 1), mesh.length(h + 2)}) / waves.unit());
  const double unit = waves.unit() / source.scale;
  for (int i = 0; i < 3; ++i) {
    const int next = (i + 1) % 3, last = (i + 2) % 3;
    // From differences, so that the nearest corner lies in its true direction.
    const Vec2 from_next = chart.corner[i] - chart.corner[next], from_last = chart.corner[i] - chart.corner[last];
    Vec2 corner = (point.barycentric[next] * from_next + point.barycentric[last] * from_last) / unit;
    if (corner.norm() < k_nearest) corner = k_nearest * (from_next + from_last).normalized();
    source.corner[i] = corner;
    source.node[i] = graph.node_of(mesh.triangles()[point.face][i]);
  }
  for (int i = 0; i < 3; ++i) {
    const Index from = source.node[i], to = source.node[(i + 1) % 3];
    source.edge[i] = waves.edge_between(from, to);
    source.entered[i] = waves.edge_between(to, from);
  }
  return source;
}

/// Direction, at the vertex of a sighting, back to the source.
double end_angle(const FanMesh& mesh, const SightingRows& rows, std::int32_t i) {
  const Vec2 place(rows.x[i], rows.y[i]), along = Vec2(rows.from_x[i], rows.from_y[i]) - place;
  const double angle = std::atan2(cross(along, -place), along.dot(-place));
  return mesh.apex_direction(rows.edge[i] / k_batch) + std::max(angle, 0.0);
}

/// The points that are no vertices, in the order in which nodes lie in memory.
std::vector<Index> inside_in_order(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points) {
  std::vector<std::pair<Index, Index>> entries;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (is_vertex(graph.mesh(), points[i])) continue;
    entries.emplace_back(graph.node_of(graph.mesh().triangles()[points[i].face][0]), static_cast<Index>(i));
  }
  std::ranges::sort(entries);
  std::vector<Index> order(entries.size());
  std::ranges::transform(entries, order.begin(), &std::pair<Index, Index>::second);
  return order;
}

}  // namespace

void DirectFanFinder::find(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points,
                           std::span<const double> limits, FanAngles angles, DirectFans& fans, const JobStage& stage) {
  see_each(graph, points, limits, stage, [&](std::size_t, int lane) {
    if (lane >= 0 && graph.is_exact()) append_row(fans.arcs);
    if (lane >= 0 && !graph.is_exact()) append_arcs(graph, lane, angles, fans.arcs);
    fans.offsets.push_back(std::ssize(fans.arcs));
  });
}

void DirectFanFinder::view(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points,
                           std::span<const double> limits, const JobStage& stage, const UseSeen& use) {
  see_each(graph, points, limits, stage, [&](std::size_t i, int lane) {
    if (lane < 0) return;
    if (!graph.is_exact()) return use(static_cast<Index>(i), SeenView(*waves_, lane));
    listed_.clear();
    for (const DirectArc& arc : row_) {
      const Vec2 place = arc.length * Vec2(std::cos(arc.start_angle), std::sin(arc.start_angle));
      listed_.push_back({graph.node_of(arc.vertex), k_none, true, arc.length, place, Vec2(arc.end_angle, 0)});
    }
    use(static_cast<Index>(i), SeenView(listed_));
  });
}

template <class Each>
void DirectFanFinder::see_each(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points,
                               std::span<const double> limits, const JobStage& stage, Each&& each) {
  if (graph.is_exact()) return see_each_exactly(graph, points, stage, each);
  for (std::size_t i = 0; i < points.size();) {
    batch_.clear();
    std::size_t end = i;
    for (; end < points.size() && batch_.size() < k_batch; ++end)
      if (!is_vertex(graph.mesh(), points[end])) batch_.push_back(end);
    const bool together = see(graph, points, limits, batch_, stage);
    for (int lane = 0; i < end; ++i) {
      if (lane == std::ssize(batch_) || batch_[lane] != i) {
        each(i, -1);
        continue;
      }
      // So many windows that all were stopped: alone each may need fewer.
      if (!together) see(graph, points, limits, Batch(batch_).subspan(lane, 1), stage);
      each(i, together ? lane : 0);
      ++lane;
    }
  }
}

/// One by one, in order of distance.
template <class Each>
void DirectFanFinder::see_each_exactly(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points,
                                       const JobStage& stage, Each&& each) {
  if (!propagator_) propagator_ = std::make_unique<VisibleVertices>(graph.unfolding());
  for (std::size_t i = 0; i < points.size(); ++i) {
    stage.check();
    const bool is_inside = !is_vertex(graph.mesh(), points[i]);
    if (is_inside) propagator_->from_point(points[i], graph.mesh().vertex_count(), row_, stage);
    each(i, is_inside ? 0 : -1);
  }
}

void DirectFanFinder::append_row(std::vector<DirectArc>& arcs) {
  std::ranges::sort(row_, {}, &DirectArc::vertex);
  arcs.insert(arcs.end(), row_.begin(), row_.end());
}

/// Tells whether all windows of a batch ran to their end.
bool DirectFanFinder::see(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points,
                          std::span<const double> limits, Batch batch, const JobStage& stage) {
  if (batch.empty()) return true;
  if (!waves_) {
    mesh_ = &graph.query_cache().fan_mesh(graph, 1, stage.part(0, 0));
    waves_ = std::make_unique<GeodesicDisks>(mesh_->waves(), graph.kernel(), disk_rule(graph.k(), graph.accuracy()));
  }
  waves_->begin(GeodesicDisks::Sources::points);
  int lane = 0;
  for (const std::size_t i : batch) {
    const double limit = limits.empty() ? std::numeric_limits<double>::infinity() : limits[i] / mesh_->waves().unit();
    waves_->add_point(lane++, face_source(graph, mesh_->waves(), points[i]), limit);
  }
  return waves_->run(stage);
}

void DirectFanFinder::append_arcs(const SaddleVertexGraph& graph, int lane, FanAngles angles,
                                  std::vector<DirectArc>& arcs) {
  const SightingRows rows = waves_->sightings();
  row_.clear();
  for (const std::int32_t i : waves_->chosen(lane)) {
    const Vec2 place(rows.x[i], rows.y[i]);
    DirectArc arc{graph.vertex_of(rows.slot[i] / k_batch), place.norm() * waves_->unit(lane), 0, 0};
    if (angles == FanAngles::both) {
      arc.start_angle = std::atan2(place.y(), place.x());
      arc.end_angle = end_angle(*mesh_, rows, i);
    }
    row_.push_back(arc);
  }
  append_row(arcs);
}

double direction_back(const SaddleVertexGraph& graph, const SeenNode& seen) {
  if (seen.edge == k_none) return seen.from.x();
  const Vec2 along = seen.from - seen.place;
  const double angle = std::atan2(cross(along, -seen.place), along.dot(-seen.place));
  return graph.query_cache().fan_mesh(graph, 1, {}).apex_direction(seen.edge) + std::max(angle, 0.0);
}

double fans_a_fan_mesh_costs(const SaddleVertexGraph& graph) {
  return graph.query_cache().has_fan_mesh() ? 0 : k_fan_mesh_cost * graph.mesh().vertex_count();
}

FanTeam::FanTeam(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points, int threads,
                 const JobStage& stage) {
  if (!graph.is_exact() &&
      std::ranges::any_of(points, [&](const SurfacePoint& point) { return !is_vertex(graph.mesh(), point); }))
    graph.query_cache().fan_mesh(graph, threads, stage);
  for (int thread = 0; thread < thread_count(threads); ++thread)
    finders_.push_back(graph.query_cache().fan_finders.lease());
}

namespace {

/// Calls see(finder, thread, batch, points, limits) for batches of the order, with what `points` and `limits` have of
/// them.
template <class See>
void for_each_batch(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points, std::span<const Index> order,
                    std::span<const double> limits, int threads, const JobStage& stage, See&& see) {
  if (order.empty()) return;
  const auto count = static_cast<Index>(order.size());
  const Index share = count / (k_chunks_a_thread * thread_count(threads)) / k_batch * k_batch;
  const Index chunk = std::clamp<Index>(share, k_batch, k_most_at_once), blocks = (count + chunk - 1) / chunk;
  const double of_mesh = graph.is_exact() ? 0 : fans_a_fan_mesh_costs(graph);
  const double before = of_mesh > 0 ? of_mesh / (of_mesh + count) : 0;
  FanTeam team(graph, points, threads, stage.part(0, before));
  const JobStage finding = stage.part(before, 1);
  struct alignas(k_apart) Work {
    std::vector<SurfacePoint> points;
    std::vector<double> limits;
  };
  std::vector<Work> works(thread_count(threads));
  WorkDone done(finding, count);
  parallel_for(blocks, threads, 1, [&](Index block, int thread) {
    auto& [own, own_limits] = works[thread];
    const Index end = std::min((block + 1) * chunk, count);
    for (Index first = block * chunk; first < end; first += k_batch) {  // what they see is used while it is at hand
      const std::span batch = order.subspan(first, std::min<Index>(k_batch, end - first));
      own.clear();
      own_limits.clear();
      for (const Index i : batch) {
        own.push_back(points[i]);
        if (!limits.empty()) own_limits.push_back(limits[i]);
      }
      see(team[thread], thread, batch, own, own_limits);
      done.add(static_cast<double>(batch.size()));
    }
  });
}

}  // namespace

void for_each_fan(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points, std::span<const double> limits,
                  FanAngles angles, int threads, const JobStage& stage, const UseFan& use) {
  const std::vector<Index> order = inside_in_order(graph, points);
  struct alignas(k_apart) Rows {
    DirectFans fans;
  };
  std::vector<Rows> rows(thread_count(threads));
  for_each_batch(graph, points, order, limits, threads, stage,
                 [&](DirectFanFinder& finder, int thread, auto batch, const auto& own, const auto& own_limits) {
                   DirectFans& fans = rows[thread].fans;
                   fans.clear();
                   finder.find(graph, own, own_limits, angles, fans, stage);
                   for (std::size_t i = 0; i < batch.size(); ++i) use(batch[i], fans[i]);
                 });
}

void for_each_view(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points, std::span<const double> limits,
                   int threads, const JobStage& stage, const UseSeen& use) {
  std::vector<Index> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  for_each_batch(graph, points, order, limits, threads, stage,
                 [&](DirectFanFinder& finder, int, auto batch, const auto& own, const auto& own_limits) {
                   finder.view(graph, own, own_limits, stage,
                               [&](Index i, const SeenView& view) { use(batch[i], view); });
                 });
}
DirectFans direct_fans(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points, int threads,
                       const JobStage& stage) {
  std::vector<std::vector<DirectArc>> rows(points.size());
  for_each_fan(graph, points, {}, FanAngles::both, threads, stage,
               [&](Index i, std::span<const DirectArc> fan) { rows[i].assign(fan.begin(), fan.end()); });
  DirectFans fans;
  fans.offsets.reserve(points.size() + 1);
  for (const auto& row : rows) {
    fans.arcs.insert(fans.arcs.end(), row.begin(), row.end());
    fans.offsets.push_back(std::ssize(fans.arcs));
  }
  return fans;
}

}  // namespace saddleback
