#include "voronoi2d/voronoi_2d_cuda.h"

#include <type_traits>

#include "support/cuda/cuda_callbacks.h"
#include "support/cuda/pinned_memory.h"
#include "voronoi2d/cuda/diagram_abi.h"
#include "voronoi2d/sites/curve_order.h"
#include "voronoi2d/sites/site_order.h"
#include "voronoi2d/weighted/weighted_vertex.h"

namespace saddleback::voronoi2d {
namespace {

/// Answers the calls of the CUDA module.
class Caller {
 public:
  Caller(std::span<const Vec2> sites, std::span<const double> weights, const Voronoi2dOptions& options,
         const JobStage& stage)
      : sites_(sites), weights_(weights), threads_(options.threads), stage_(stage) {
    if (!options.is_pinned) return;
    const auto take = [](auto&... arrays) { ((arrays = std::decay_t<decltype(arrays)>(&pinned_memory())), ...); };
    take(result_.sites, result_.site_of, result_.cell_places, result_.cell_sites, result_.cell_offsets,
         result_.corner_vertices, result_.side_edges, result_.edges, result_.edge_sites, result_.vertices);
  }

  DiagramCaller calls() {
    return {this,
            [](void* self, double fraction) {
              auto& caller = *static_cast<Caller*>(self);
              return caller.guard_.run([&] { caller.stage_.update(fraction); });
            },
            [](void* self, std::uint32_t* places, std::int32_t* order) {
              auto& caller = *static_cast<Caller*>(self);
              return caller.guard_.run([&] { caller.sort(places, order); });
            },
            [](void* self, const DiagramSizes& most, DiagramArrays* arrays) {
              auto& caller = *static_cast<Caller*>(self);
              return caller.guard_.run([&] { *arrays = caller.make_room(most); });
            },
            [](void* self, const RoughVertex* vertices, std::int32_t count) {
              auto& caller = *static_cast<Caller*>(self);
              return caller.guard_.run([&] { caller.place({vertices, static_cast<std::size_t>(count)}); });
            },
            [](void* self, const DiagramSizes& sizes) {
              auto& caller = *static_cast<Caller*>(self);
              return caller.guard_.run([&] { caller.resize(sizes); });
            }};
  }
  const CudaGuard& guard() const { return guard_; }
  Voronoi2d take() { return std::move(result_); }

 private:
  /// The caller's sites may be somebody's who changes them meanwhile: what reads them twice reads a copy.
  void copy_sites() {
    if (result_.sites.empty()) result_.sites = copy_of(sites_, threads_, stage_.part(0, 0));
  }
  /// Returns where the device copies the sites. It copies to what is pinned alone and faster than cores do, after whose
  /// reading it would need longer for the caller's.
  double* place_for_sites() {
    if (result_.sites.get_allocator().source != &pinned_memory()) {
      copy_sites();
      return nullptr;
    }
    resize(result_.sites, sites_.size());
    return result_.sites.data()->data();
  }

  void sort(std::uint32_t* places, std::int32_t* order) {
    copy_sites();
    const LargeArray<Placed> items = curve_order(result_.sites, threads_, stage_.part(0.1, 0.2));
    for (std::size_t i = 0; i < items.size(); ++i) {
      places[i] = items[i].key;
      order[i] = items[i].index;
    }
  }

  DiagramArrays make_room(const DiagramSizes& most) {
    double* const sites = place_for_sites();
    resize(most);
    return {sites,
            result_.site_of.data(),
            result_.cell_places.data(),
            result_.cell_sites.data(),
            result_.cell_offsets.data(),
            result_.corner_vertices.data(),
            result_.side_edges.data(),
            result_.edges.data()->data(),
            result_.edge_sites.data()->data(),
            result_.vertices.data()->data()};
  }

  void place(std::span<const RoughVertex> vertices) {
    // The caller's: other devices may still be copying theirs.
    const auto site = [&](Index i) { return predicates::WeightedPoint2{sites_[i].x(), sites_[i].y(), weights_[i]}; };
    for (const RoughVertex& rough : vertices) {
      const predicates::WeightedPoint2 before = site(rough.sites[1]), after = site(rough.sites[2]);
      result_.vertices[rough.vertex] = rough_vertex(site(rough.sites[0]), &before, &after);
    }
  }

  void resize(const DiagramSizes& sizes) {
    const auto edges = static_cast<std::size_t>(sizes.edges), cells = static_cast<std::size_t>(sizes.cells);
    resize(result_.site_of, sites_.size());
    resize(result_.cell_places, sites_.size());
    resize(result_.cell_sites, cells);
    resize(result_.cell_offsets, cells + 1);
    resize(result_.corner_vertices, 2 * edges);
    resize(result_.side_edges, 2 * edges);
    resize(result_.edges, edges);
    resize(result_.edge_sites, edges);
    resize(result_.vertices, static_cast<std::size_t>(sizes.vertices));
  }

  template <class T>
  void resize(LargeArray<T>& array, std::size_t size) {
    const JobStage now = stage_.part(0, 0);
    now.check();
    if (array.capacity() < size && array.get_allocator().source == &pinned_memory())
      make_pinned_room(size * sizeof(T), threads_, now);
    array.resize(size);
  }

  std::span<const Vec2> sites_;
  std::span<const double> weights_;
  int threads_;
  const JobStage& stage_;
  CudaGuard guard_;
  Voronoi2d result_;
};

}  // namespace

std::optional<Voronoi2d> cuda_voronoi(std::span<const Vec2> sites, std::span<const double> weights,
                                      const Voronoi2dOptions& options, const JobStage& stage) {
  const CudaModule& cuda = loaded_cuda_module();
  DiagramRequest request;
  request.devices = options.cuda_devices.data();
  request.device_count = static_cast<int>(options.cuda_devices.size());
  request.most_bytes = cuda_memory_limit();
  request.sites = sites.empty() ? nullptr : sites.front().data();
  request.weights = weights.empty() ? nullptr : weights.data();
  request.count = static_cast<std::int32_t>(sites.size());

  Caller caller(sites, weights, options, stage);
  DeviceTimes times;
  CudaReason reason;
  const CudaStatus status = cuda.find_voronoi(request, caller.calls(), times, reason);
  if (status == CudaStatus::left) return std::nullopt;
  caller.guard().check(status, reason);
  Voronoi2d result = caller.take();
  result.device_times = times;
  return result;
}

}  // namespace saddleback::voronoi2d
