#include "geodesics/queries/graph_search_cuda.h"

#include <array>
#include <cmath>
#include <limits>

#include "geodesics/queries/arc_scale.h"
#include "geodesics/queries/query_cache.h"
#include "geodesics/queries/search_abi.h"
#include "support/cuda/cuda_callbacks.h"

namespace saddleback {
namespace {

// The step of the front, in units of the shortest arc of the median node.
constexpr double k_front_step = 8, k_median = 0.5;

/// The first number beyond a limit.
double bound_of(double limit) { return std::nextafter(limit, std::numeric_limits<double>::infinity()); }

/// Searches; `to` tells where to write; the rest of a request is filled in here. `first`: of each field's seeds, after
/// a 0.
void search(const SaddleVertexGraph& graph, int device, const FlatSeeds& seeds, std::span<const std::int64_t> first,
            double bound, SearchRequest to, const JobStage& stage) {
  DeviceGraphs& graphs = graph.query_cache().device_graphs;
  DeviceTimes times;
  const DeviceGraphs::Kept kept = graphs.on(device, graph, times);
  to.most_bytes = cuda_memory_limit();
  to.field_count = static_cast<std::int32_t>(first.size() - 1);
  to.first_seed = first.data();
  to.seed_nodes = seeds.nodes.data();
  to.seed_sources = to.sources ? seeds.sources.data() : nullptr;
  to.seed_distances = seeds.distances.data();
  to.bound = bound;
  to.step = kept.step;
  struct Caller {
    const JobStage& stage;
    CudaGuard guard;
  } caller{stage, {}};
  const SearchCaller calls{&caller, [](void* self, double fraction) {
                             Caller& asked = *static_cast<Caller*>(self);
                             return asked.guard.run([&] { asked.stage.update(fraction); });
                           }};
  CudaReason reason;
  caller.guard.check(loaded_cuda_module().search(*kept.graph, to, calls, times, reason), reason);
  graphs.tell(times);
  stage.update(1);
}

}  // namespace

DeviceGraphs::Kept DeviceGraphs::on(int device, const SaddleVertexGraph& graph, DeviceTimes& times) {
  const CudaModule& cuda = loaded_cuda_module();
  const std::lock_guard lock(mutex_);
  if (kept_ && kept_->device == device) return *kept_;
  kept_.reset();
  const ArcRows& arcs = graph.arcs();
  arcs.look_at_all();
  const CudaGraphRequest request{.device = device,
                                 .most_bytes = cuda_memory_limit(),
                                 .node_count = arcs.node_count(),
                                 .arc_count = arcs.count(),
                                 .offsets = arcs.offsets().data(),
                                 .words = arcs.words().data(),
                                 .nodes = graph.nodes().data(),
                                 .packing = arcs.codec().packing()};
  CudaGraph* graph_on_device = nullptr;
  CudaReason reason;
  CudaGuard().check(cuda.put_graph(request, &graph_on_device, &times.upload, reason), reason);
  kept_ = Kept{device, k_front_step * shortest_arcs_below(arcs, k_median), {graph_on_device, cuda.drop_graph}};
  return *kept_;
}

void DeviceGraphs::tell(const DeviceTimes& times) {
  const std::lock_guard lock(mutex_);
  last_ = times;
}

std::optional<DeviceTimes> DeviceGraphs::last_times() const {
  const std::lock_guard lock(mutex_);
  return last_;
}

bool DeviceGraphs::any() const {
  const std::lock_guard lock(mutex_);
  return kept_.has_value();
}

void FlatSeeds::resize(std::size_t count) {
  nodes.resize(count);
  sources.resize(count);
  distances.resize(count);
}

void FlatSeeds::set(std::size_t i, const NodeSeed& seed) {
  nodes[i] = seed.node;
  sources[i] = seed.source;
  distances[i] = seed.distance;
}

void cuda_search(const SaddleVertexGraph& graph, std::span<const std::vector<Seed>> seeds, const QueryOptions& options,
                 const FieldsTo& to, const JobStage& stage) {
  const double bound = bound_of(options.limit);
  std::vector<std::int64_t> first{0};
  std::size_t count = 0;
  for (const std::vector<Seed>& field : seeds) count += field.size();
  FlatSeeds flat;
  flat.resize(count);
  count = 0;
  for (const std::vector<Seed>& field : seeds) {
    for (const Seed& seed : field)
      if (seed.distance < bound) flat.set(count++, {graph.node_of(seed.vertex), seed.source, seed.distance});
    first.push_back(static_cast<std::int64_t>(count));
  }
  search(graph, options.cuda_device, flat, first, bound, {.distances = to.distances, .sources = to.sources}, stage);
}

void cuda_nearest_sources(const SaddleVertexGraph& graph, int device, const FlatSeeds& seeds, const JobStage& stage,
                          std::vector<double>& distances, std::vector<Index>& sources) {
  distances.resize(graph.mesh().vertex_count());
  sources.resize(distances.size());
  const std::array<std::int64_t, 2> all{0, std::ssize(seeds.nodes)};
  search(graph, device, seeds, all, bound_of(QueryOptions().limit),
         {.distances = distances.data(), .sources = sources.data(), .by_node = true}, stage);
}

}  // namespace saddleback
