// The graph's questions and answers: sources become seeds, a search does the rest.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <new>

#include "saddleback/error.h"
#include "saddleback/saddle_vertex_graph.h"

#include "geodesics/label_propagation.h"
#include "geodesics/point_targets.h"
#include "geodesics/query_cache.h"
#include "support/memory.h"
#include "support/parallel.h"

namespace saddleback {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();

void check(const SaddleVertexGraph& graph, const QuerySources& sources, const QueryOptions& options = {}) {
  if (sources.size() == 0) throw InputError("sources: wanted at least one source, got none");
  check_surface_points(graph.mesh(), sources.points, "sources");
  if (std::isnan(options.limit) || options.limit < 0)
    throw InputError(message("limit: wanted a distance of 0 or more, got ", options.limit));
}

/// In sentences: 12.3 GB.
std::string in_gigabytes(double bytes) { return message(std::ceil(bytes / 1e8) / 10, " GB"); }

DistanceFields allocate_fields(std::size_t count, std::size_t vertex_count) {
  const double bytes = static_cast<double>(count) * static_cast<double>(vertex_count) * sizeof(double);
  const std::string too_many = message("sources: ", count, " fields of ", vertex_count, " vertices take ",
                                       in_gigabytes(bytes), ", more than the memory there is");
  const std::size_t available = available_memory();
  if (available > 0 && bytes > static_cast<double>(available))
    throw InputError(message(too_many, " (", in_gigabytes(static_cast<double>(available)), ")"));
  try {
    return {count, vertex_count, std::make_unique_for_overwrite<double[]>(count * vertex_count)};
  } catch (const std::bad_alloc&) {
    throw InputError(too_many);
  }
}

double through_fan(const GraphSearch& search, const SaddleVertexGraph& graph, const PointFan& fan) {
  double best = k_infinity;
  for (const PointFan::Arc& arc : fan.arcs) best = std::min(best, search.distance(graph, arc.vertex) + arc.length);
  return best;
}

}  // namespace

std::vector<double> SaddleVertexGraph::distances(const QuerySources& sources, const QueryOptions& options,
                                                 Job* job) const {
  const JobStage stage(job, "Measuring distances");
  check(*this, sources, options);
  const std::vector<PointFan> fans = find_fans(*this, sources.points, stage);
  const auto search = queries_->field_searches.lease();
  search->run(*this, seeds_of(fans), options, SearchLabels::none, stage);
  std::vector<double> result(mesh_->vertex_count());
  search->write_distances(*this, result);
  return result;
}

NearestField SaddleVertexGraph::nearest(const QuerySources& sources, const QueryOptions& options, Job* job) const {
  const JobStage stage(job, "Finding nearest sources");
  check(*this, sources, options);
  const std::vector<PointFan> fans = find_fans(*this, sources.points, stage);
  LabelField field = propagate_labels(*this, seeds_of(fans), options, false, stage);
  return {std::move(field.distance), std::move(field.source)};
}

DistanceFields SaddleVertexGraph::fields(const QuerySources& sources, const QueryOptions& options, int threads,
                                         Job* job) const {
  const JobStage stage(job, "Measuring distance fields");
  check(*this, sources, options);
  if (threads < 0) throw InputError(message("threads: wanted 0 (all) or more, got ", threads));
  const auto vertex_count = static_cast<std::size_t>(mesh_->vertex_count());
  DistanceFields result = allocate_fields(sources.size(), vertex_count);
  const std::vector<PointFan> fans = find_fans(*this, sources.points, stage);
  std::vector<ScratchPool<GraphSearch>::Lease> searches;
  const auto count = static_cast<Index>(fans.size());
  for (int thread = 0; thread < std::min(thread_count(threads), count); ++thread)
    searches.push_back(queries_->field_searches.lease());
  std::atomic<Index> done{0};
  parallel_for(count, threads, 1, [&](Index i, int thread) {
    GraphSearch& search = *searches[thread];
    search.run(*this, seeds_of({&fans[i], 1}), options, SearchLabels::none, stage.part(0, 0));
    search.write_distances(*this, {result.values.get() + static_cast<std::size_t>(i) * vertex_count, vertex_count});
    stage.update(static_cast<double>(done.fetch_add(1, std::memory_order_relaxed) + 1) / count);
  });
  return result;
}

PointDistance SaddleVertexGraph::distance(const SurfacePoint& a, const SurfacePoint& b, Job* job) const {
  const JobStage stage(job, "Measuring a distance");
  check_surface_point(*mesh_, a, "a");
  check_surface_point(*mesh_, b, "b");
  const auto component = [&](const SurfacePoint& point) {
    return mesh_->component_of(mesh_->triangles()[point.face][0]);
  };
  if (component(a) != component(b)) return {k_infinity, 0};
  const Landmarks& landmarks = queries_->landmarks(*this, stage);
  const auto finder = queries_->fan_finders.lease();
  const PointFan fans[] = {finder->find(*this, a), finder->find(*this, b)};
  const double direct = direct_length(*this, a, fans[0], b, fans[1]);
  const auto search = queries_->point_searches.lease();
  const PointDistance result = search->run(*this, landmarks, fans[0], fans[1], position(*mesh_, b), direct, stage);
  stage.update(1);
  return result;
}

std::vector<double> SaddleVertexGraph::distances_to(const QuerySources& sources, const SurfacePoints& targets,
                                                    Job* job) const {
  const JobStage stage(job, "Measuring distances to points");
  check(*this, sources);
  check_surface_points(*mesh_, targets, "targets");
  const std::vector<PointFan> from = find_fans(*this, sources.points, stage), to = find_fans(*this, targets, stage);
  const auto search = queries_->field_searches.lease();
  search->run(*this, seeds_of(from), {}, SearchLabels::none, stage.part(0, 0.9));
  const NearbySources nearby(from);
  std::vector<double> result(targets.size());
  std::vector<Index> seen;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    stage.check();
    result[i] = through_fan(*search, *this, to[i]);
    nearby.find(to[i], seen);
    for (const Index s : seen)
      result[i] = std::min(result[i], direct_length(*this, sources.points[s], from[s], targets[i], to[i]));
  }
  stage.update(1);
  return result;
}

}  // namespace saddleback
