#include "geodesics/twin_search.h"

#include <cmath>
#include <limits>

#include "geodesics/arc_scale.h"
#include "geodesics/query_cache.h"
#include "geodesics/search_twin.h"
#include "support/twin_caller.h"

namespace saddleback {
namespace {

// Of the median node's shortest arc.
constexpr double k_front_step = 8, k_median = 0.5;

/// Seeds of all fields in flat arrays.
struct FlatSeeds {
  std::vector<std::int64_t> first{0};
  std::vector<std::int32_t> nodes, sources;
  std::vector<double> distances;

  FlatSeeds(const SaddleVertexGraph& graph, std::span<const std::vector<Seed>> fields, double bound) {
    for (const std::vector<Seed>& seeds : fields) {
      for (const Seed& seed : seeds) {
        if (seed.distance >= bound) continue;
        nodes.push_back(graph.node_of(seed.vertex));
        sources.push_back(seed.source);
        distances.push_back(seed.distance);
      }
      first.push_back(static_cast<std::int64_t>(nodes.size()));
    }
  }
};

}  // namespace

DeviceGraphs::Kept DeviceGraphs::on(int device, const SaddleVertexGraph& graph, DeviceTimes& times) {
  const CudaTwins& twins = loaded_twins();
  const std::lock_guard lock(mutex_);
  if (kept_ && kept_->device == device) return *kept_;
  kept_.reset();
  const ArcRows& arcs = graph.arcs();
  const GraphTwinRequest request{.device = device,
                                 .most_bytes = cuda_memory_limit(),
                                 .node_count = arcs.node_count(),
                                 .arc_count = arcs.count(),
                                 .offsets = arcs.offsets().data(),
                                 .words = arcs.words().data(),
                                 .nodes = graph.nodes().data(),
                                 .packing = arcs.codec().packing()};
  GraphTwin* twin = nullptr;
  TwinReason reason;
  TwinGuard().check(twins.put_graph(request, &twin, &times.upload, reason), reason);
  kept_ = Kept{device, k_front_step * shortest_arcs_below(arcs, k_median), {twin, twins.drop_graph}};
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

void twin_search(const SaddleVertexGraph& graph, std::span<const std::vector<Seed>> seeds, const QueryOptions& options,
                 const FieldsTo& to, const JobStage& stage) {
  DeviceGraphs& graphs = graph.query_cache().device_graphs;
  DeviceTimes times;
  const DeviceGraphs::Kept kept = graphs.on(options.cuda_device, graph, times);
  const double bound = std::nextafter(options.limit, std::numeric_limits<double>::infinity());
  const FlatSeeds flat(graph, seeds, bound);
  SearchTwinRequest request{.most_bytes = cuda_memory_limit(),
                            .field_count = static_cast<std::int32_t>(seeds.size()),
                            .first_seed = flat.first.data(),
                            .seed_nodes = flat.nodes.data(),
                            .seed_sources = to.sources ? flat.sources.data() : nullptr,
                            .seed_distances = flat.distances.data(),
                            .bound = bound,
                            .step = kept.step,
                            .distances = to.distances,
                            .sources = to.sources};
  struct Caller {
    const JobStage& stage;
    TwinGuard guard;
  } caller{stage, {}};
  const SearchTwinCaller calls{&caller, [](void* self, double fraction) {
                                 Caller& asked = *static_cast<Caller*>(self);
                                 return asked.guard.run([&] { asked.stage.update(fraction); });
                               }};
  TwinReason reason;
  caller.guard.check(loaded_twins().search(*kept.twin, request, calls, times, reason), reason);
  graphs.tell(times);
  stage.update(1);
}

}  // namespace saddleback
