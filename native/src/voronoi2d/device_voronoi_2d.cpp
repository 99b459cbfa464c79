// Diagrams that stay on the device that found them.

#include "voronoi2d/device_voronoi_2d.h"

#include <span>

#include "saddleback/error.h"
#include "saddleback/types.h"

#include "support/cuda/cuda_callbacks.h"
#include "voronoi2d/cuda/diagram_abi.h"
#include "voronoi2d/sites/check_options.h"
#include "voronoi2d/sites/curve_order.h"
#include "voronoi2d/sites/site_order.h"

namespace saddleback {
namespace {

using namespace voronoi2d;

/// Answers the calls of the CUDA module. There is no room to be made.
struct Caller {
  std::span<const Vec2> sites;
  const JobStage& stage;
  CudaGuard guard;

  DiagramCaller calls() {
    return {this,
            [](void* self, double fraction) {
              auto& caller = *static_cast<Caller*>(self);
              return caller.guard.run([&] { caller.stage.update(fraction); });
            },
            [](void* self, std::uint32_t* places, std::int32_t* order) {
              auto& caller = *static_cast<Caller*>(self);
              return caller.guard.run([&] {
                // Somebody may change the sites meanwhile.
                const LargeArray<Vec2> own = copy_of(caller.sites, 0, caller.stage.part(0.1, 0.1));
                for (const Placed& item : curve_order(own, 0, caller.stage.part(0.1, 0.2))) {
                  *places++ = item.key;
                  *order++ = item.index;
                }
              });
            },
            nullptr,
            nullptr,
            nullptr};
  }
};

DeviceVoronoi2d arrays_of(const DevicePlane& plane, int device, Index site_count) {
  const std::shared_ptr<void> owner(
      plane.owner, [drop = loaded_cuda_module().drop_voronoi](void* kept) { drop(static_cast<KeptPlane*>(kept)); });
  const auto integers = [&](const std::int32_t* data, std::int64_t rows, int columns) {
    return DeviceArray{data, data ? rows : 0, columns, false, device, owner};
  };
  const std::int64_t offsets = plane.cells + std::int64_t{1};
  return {.vertices = {plane.vertex_places, plane.vertex_places ? plane.vertices : 0, 2, true, device, owner},
          .edges = integers(plane.edge_vertices, plane.edges, 2),
          .edge_sites = integers(plane.edge_sites, plane.edges, 2),
          .site_of = integers(plane.site_of, site_count, 1),
          .cell_places = integers(plane.cell_places, site_count, 1),
          .cell_sites = integers(plane.cell_sites, plane.cells, 1),
          .cell_offsets = integers(plane.cell_offsets, offsets, 1),
          .corner_vertices = integers(plane.corner_vertices, plane.sides, 1),
          .side_edges = integers(plane.side_edges, plane.sides, 1),
          .triangles = integers(plane.triangle_sites, plane.triangles, 3),
          .times = {}};
}

}  // namespace

void DeviceArray::copy_to(void* host) const {
  CudaReason reason;
  CudaGuard().check(loaded_cuda_module().copy_back(device, data, host, nbytes(), reason), reason);
}

std::optional<DeviceVoronoi2d> voronoi_2d_on_device(const double* sites, std::int64_t count,
                                                    const DeviceVoronoi2dOptions& options, Job* job) {
  constexpr std::int64_t k_fewest = 3;
  check_options({}, static_cast<std::size_t>(count));
  if (count < k_fewest) return std::nullopt;
  const JobStage stage(job, "Voronoi diagram");
  DevicePlane plane{};
  DiagramRequest request;
  request.devices = &options.device;
  request.device_count = 1;
  request.most_bytes = cuda_memory_limit();
  request.sites = sites;
  request.count = static_cast<std::int32_t>(count);
  request.sites_are_there = options.sites_are_there;
  request.kept = &plane;
  request.only_triangles = options.only_triangles;
  Caller caller{{}, stage, {}};
  // Two doubles each, as Vec2 holds them.
  if (!options.sites_are_there) caller.sites = {reinterpret_cast<const Vec2*>(sites), static_cast<std::size_t>(count)};
  DeviceTimes times;
  CudaReason reason;
  const CudaStatus status = loaded_cuda_module().find_voronoi(request, caller.calls(), times, reason);
  if (status == CudaStatus::left) return std::nullopt;
  caller.guard.check(status, reason);
  DeviceVoronoi2d result = arrays_of(plane, options.device, request.count);
  result.times = times;
  stage.update(1);
  return result;
}

}  // namespace saddleback
