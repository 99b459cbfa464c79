// The graph's questions and answers: sources become seeds, a search does the rest. All searches find the same bits;
// which one runs:
//  - GraphSearch: the fields of this file, by buckets; on demand by Dijkstra's heap, which checks the buckets.
//  - cuda_search: the same fields where options.cuda_device asks for it.
//  - PointSearch: the distance between two points, led by landmarks.
//  - nearest_sources (parted_search.h): the nearest of a tessellation's sites for every vertex, by several threads.
//  - tessellation/log_map/relabeling.h: the same where only some of the sites have moved.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <new>

#include "saddleback/error.h"
#include "saddleback/geodesics/saddle_vertex_graph.h"

#include "geodesics/queries/graph_search.h"
#include "geodesics/queries/graph_search_cuda.h"
#include "geodesics/queries/point_targets.h"
#include "geodesics/queries/query_cache.h"
#include "support/memory/memory.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();

void check(const SaddleVertexGraph& graph, const QuerySources& sources, const QueryOptions& options = {}) {
  if (sources.size() == 0) throw InputError("sources: wanted at least one source, got none");
  check_surface_points(graph.mesh(), sources.points, "sources");
  if (std::isnan(options.limit) || options.limit < 0)
    throw InputError(message("limit: wanted a distance of 0 or more, got ", options.limit));
}

bool by_device(const QueryOptions& options) { return options.cuda_device >= 0; }

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

/// Holds how a query's time is spread over its fans and so many fields.
struct QueryStages {
  QueryStages(const SaddleVertexGraph& graph, const QuerySources& sources, double field_count, const JobStage& stage) {
    const double cost = cost_of_fans(graph, sources), vertices = field_count * graph.mesh().vertex_count(),
                 share = cost / (cost + std::max(vertices, cost_of_seeds(graph, sources.points)));
    fans = stage.part(0, share);
    fields = stage.part(share, 1);
  }
  JobStage fans, fields;
};

}  // namespace

std::vector<double> SaddleVertexGraph::distances(const QuerySources& sources, const QueryOptions& options,
                                                 Job* job) const {
  const JobStage stage(job, "Measuring distances");
  check(*this, sources, options);
  const QueryStages stages(*this, sources, 1, stage);
  const SourceFans from = find_fans(*this, sources, stages.fans, {.limit = options.limit});
  std::vector<double> result(mesh_->vertex_count());
  if (by_device(options)) {
    cuda_search(*this, {{seeds_of(from.fans)}}, options, {result.data(), nullptr}, stages.fields);
    return result;
  }
  const auto search = queries_->field_searches.lease();
  search->run(*this, seeds_of(from.fans), options, SearchLabels::none, stages.fields);
  search->write_distances(*this, result);
  return result;
}

NearestField SaddleVertexGraph::nearest(const QuerySources& sources, const QueryOptions& options, Job* job) const {
  const JobStage stage(job, "Finding nearest sources");
  check(*this, sources, options);
  const QueryStages stages(*this, sources, 1, stage);
  const SourceFans from = find_fans(*this, sources, stages.fans, {.limit = options.limit});
  if (by_device(options)) {
    NearestField field{std::vector<double>(mesh_->vertex_count()), std::vector<Index>(mesh_->vertex_count())};
    const FieldsTo to{field.distance.data(), field.source.data()};
    cuda_search(*this, {{seeds_of(from.fans)}}, options, to, stages.fields);
    return field;
  }
  LabelField field = propagate_labels(*this, seeds_of(from.fans), options, false, stages.fields);
  return {std::move(field.distance), std::move(field.source)};
}

DistanceFields SaddleVertexGraph::fields(const QuerySources& sources, const QueryOptions& options, int threads,
                                         Job* job) const {
  const JobStage stage(job, "Measuring distance fields");
  check(*this, sources, options);
  if (threads < 0) throw InputError(message("threads: wanted 0 (all) or more, got ", threads));
  const auto vertex_count = static_cast<std::size_t>(mesh_->vertex_count());
  DistanceFields result = allocate_fields(sources.size(), vertex_count);
  const QueryStages stages(*this, sources, static_cast<double>(sources.size()), stage);
  const std::vector<PointFan> fans =
      find_fans(*this, sources, stages.fans, {.limit = options.limit, .threads = threads}).fans;
  if (by_device(options)) {
    std::vector<std::vector<Seed>> seeds;
    for (const PointFan& fan : fans) seeds.push_back(seeds_of({&fan, 1}));
    cuda_search(*this, seeds, options, {result.values.get(), nullptr}, stages.fields);
    return result;
  }
  std::vector<ScratchPool<GraphSearch>::Lease> searches;
  const auto count = static_cast<Index>(fans.size());
  for (int thread = 0; thread < std::min(thread_count(threads), count); ++thread)
    searches.push_back(queries_->field_searches.lease());
  const JobStage& rest = stages.fields;
  std::atomic<Index> done{0};
  parallel_for(count, threads, 1, [&](Index i, int thread) {
    GraphSearch& search = *searches[thread];
    search.run(*this, seeds_of({&fans[i], 1}), options, SearchLabels::none, rest.part(0, 0));
    search.write_distances(*this, {result.values.get() + static_cast<std::size_t>(i) * vertex_count, vertex_count});
    rest.update(static_cast<double>(done.fetch_add(1, std::memory_order_relaxed) + 1) / count);
  });
  return result;
}

bool SaddleVertexGraph::is_on_device() const { return queries_->device_graphs.any(); }

std::optional<DeviceTimes> SaddleVertexGraph::query_times() const { return queries_->device_graphs.last_times(); }

PointDistance SaddleVertexGraph::distance(const SurfacePoint& a, const SurfacePoint& b, Job* job) const {
  const JobStage stage(job, "Measuring a distance");
  check_surface_point(*mesh_, a, "a");
  check_surface_point(*mesh_, b, "b");
  const auto component = [&](const SurfacePoint& point) {
    return mesh_->component_of(mesh_->triangles()[point.face][0]);
  };
  if (component(a) != component(b)) return {k_infinity, 0};
  const Landmarks& landmarks = queries_->landmarks(*this, stage);
  const std::vector<PointFan> fans = find_fans(*this, {a, b}, stage.part(0, 0), {.threads = 1});
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
  const double source_cost = cost_of_fans(*this, sources);
  const bool after_points = cost_of_fans(*this, sources.points) > 0;
  const double target_cost = cost_of_fans(*this, targets, after_points ? FirstFans::later : FirstFans::maybe);
  // The more sources, the more straight ways there are to try.
  constexpr double k_cost_of_sight = 2, k_more_sources = 0.35;
  const double sight_cost = k_cost_of_sight * std::pow(static_cast<double>(sources.points.size()), k_more_sources) *
                            static_cast<double>(targets.size());
  const double all = source_cost + mesh_->vertex_count() + target_cost + sight_cost;
  const double prepared = source_cost / all, searched = (source_cost + mesh_->vertex_count()) / all;
  const WatchedPlaces places(targets);
  const SourceFans from = find_fans(*this, sources, stage.part(0, prepared), {.places = &places});
  const auto search = queries_->field_searches.lease();
  search->run(*this, seeds_of(from.fans), {}, SearchLabels::none, stage.part(prepared, searched));
  std::vector<double> result = distances_at(
      *this, sources.points, from.fans, [&](Index vertex) { return search->distance(*this, vertex); }, targets,
      from.at_places, stage.part(searched, 1));
  stage.update(1);
  return result;
}

}  // namespace saddleback
