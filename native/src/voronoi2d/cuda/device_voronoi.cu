// Voronoi diagrams of the plane on a CUDA device: order, cells by tiles, cells that these could not tell, numbers. The
// answer is the processor's, to the bit.

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "support/cuda/device_stream.h"
#include "support/cuda/host_copies.h"
#include "voronoi2d/cuda/device_found_cells.cuh"
#include "voronoi2d/cuda/device_voronoi.h"

namespace saddleback {
namespace {

using namespace voronoi2d;

/// Returns what a diagram takes at most at once, in bytes.
std::uint64_t bytes_needed(const DiagramRequest& request) {
  const std::uint64_t each = request.weights ? 440 : 360;
  return static_cast<std::uint64_t>(request.count) * each + (1 << 21);
}

/// The sites that have cells, by rank.
struct CellSites {
  std::int32_t count;
  const double2* at;
  const double* weights;  ///< or null
  const std::int32_t *original, *cell_places;
  const double2* given;  ///< all sites, by index
  cudaEvent_t are_there;
};

/// A diagram found by one or several devices. All have all sites, each finds and numbers the cells of some tiles.
class Builder {
 public:
  Builder(const DiagramRequest& request, const DiagramCaller& caller)
      : request_(request),
        team_({request.devices, static_cast<std::size_t>(request.device_count)}),
        caller_(caller, team_),
        arrays_(team_),
        times_(static_cast<std::size_t>(request.device_count)) {}

  DeviceTimes build() {
    team_.run([&](int member) { build_part(member); });
    return slowest(times_);
  }

 private:
  /// Says the share of all time, at the end of each part, as seen with many sites in memory that is not pinned.
  struct Share {
    static constexpr double upload = 0.11, order = 0.15, find = 0.5, unite = 0.55;
  };

  bool wants_triangles() const { return request_.kept && request_.only_triangles; }  ///< and nothing else

  void build_part(int member) {
    const int device = team_.device(member);
    check_cuda(cudaSetDevice(device), "choosing the device");
    check_device_room("the diagram", bytes_needed(request_), request_.most_bytes);
    keep_freed_memory(device);
    DeviceDiagram::load(team_.members(), wants_triangles());
    const auto report = [&](double fraction) { caller_.report(member, fraction); };
    DeviceTimes& times = times_[static_cast<std::size_t>(member)];
    auto own_stream = std::make_unique<Stream>();
    const cudaStream_t stream = *own_stream;
    Stopwatch uploading(stream);
    DeviceBuffer<double2> uploaded;
    DeviceBuffer<double> weights;
    if (request_.sites_are_there) {
      expect_sites_on(device);
    } else {
      const auto* const sites = reinterpret_cast<const double2*>(request_.sites);
      uploaded = upload(sites, stream, [&](double share) { report(Share::upload * share); });
    }
    if (request_.weights) weights = upload(request_.weights, stream, [&](double) { report(Share::upload); });
    uploading.end();
    report(Share::upload);
    team_.meet();  // or who is done first would take the others' copies for the time that cells take
    Stopwatch watch(stream);
    const double2* const given =
        request_.sites_are_there ? reinterpret_cast<const double2*>(request_.sites) : uploaded.data();
    DeviceOrder order = ordered(member, given, stream);
    std::optional<VisibleSites> visible;
    if (request_.weights) visible.emplace(seen(order, weights.data(), stream));
    const StreamEvent is_ordered;
    is_ordered.record(stream);
    times.order = watch.lap();
    times.upload = uploading.read();
    report(Share::order);
    if (visible) {
      WeightedCellFinder cells(*visible, member, team_.members(), stream);
      const CellSites sites{visible->count(),       visible->at(), visible->weights(), visible->original(),
                            visible->cell_places(), given,         is_ordered};
      find(member, cells, sites, order, watch, own_stream);
    } else {
      CellFinder cells(order, member, team_.members(), !request_.kept, stream);
      find(member, cells,
           {order.cell_count(), order.at(), nullptr, order.original(), order.cell_places(), given, is_ordered}, order,
           watch, own_stream);
    }
  }

  template <class Finder>
  void find(int member, Finder& cells, const CellSites& sites, DeviceOrder& order, Stopwatch& watch,
            std::unique_ptr<Stream>& own_stream) {
    const int device = team_.device(member);
    const auto report = [&](double fraction) { caller_.report(member, fraction); };
    DeviceTimes& times = times_[static_cast<std::size_t>(member)];
    const cudaStream_t stream = *own_stream;
    const PlanePart part{arrays_, member, cells.begins()};
    const auto report_cells = [&](double done) { report(Share::order + (Share::find - Share::order) * done); };
    std::optional<DeviceDiagram> diagram;
    const auto take_memory = [&](std::int32_t sides) {
      diagram.emplace(part, sites.count, sides, sites.weights != nullptr, stream);
    };
    if (part.is_all()) {
      cells.start(device, report_cells);
    } else {
      // While the device finds them, which takes longer.
      const auto meanwhile = [&] { take_memory(DeviceDiagram::most_sides(sites.count)); };
      cells.start(device, report_cells, meanwhile, [&] { diagram.reset(); });
    }
    cells.share(part);
    watch.end();
    if (member == 0 && !request_.kept) make_room(sites.count);
    team_.meet();
    HostCopies copies(stream);
    copy_sites(order, sites, part, copies);
    const std::int32_t sides = cells.finish(times, watch, report_cells);
    times.find = watch.read();
    report(Share::find);
    watch.start();
    if (!diagram) take_memory(sides);
    report(Share::find);  // the driver may have taken a while
    if (!diagram->has(sides)) throw LeftOver();
    if (member == 0)
      copies.to_host(cells.offsets().data(), static_cast<std::size_t>(sites.count) + 1, to_.cell_offsets);
    const DeviceCells rows{sites.count,          part.cells(),   sites.at,
                           sites.weights,        sites.original, cells.offsets().data(),
                           diagram->cell_sides()};
    const auto wait = [&] {
      wait_polling(
          stream, [&](cudaStream_t) { report(Share::find); }, [&](cudaStream_t aside) { diagram->stop(aside); });
    };
    diagram->join(rows, cells.offsets(), cells.lists());
    DeviceBuffer<std::int32_t> triangles;
    if (wants_triangles()) {
      triangles = diagram->triangles(rows, wait);
    } else {
      diagram->number(rows, copies, to_);
    }
    watch.end();
    wait();
    times.unite = watch.read();
    copies.finish([&](double share) { report(Share::unite + (1 - Share::unite) * share); });
    if (!diagram->fits()) throw LeftOver();
    times.download = watch.lap();
    if (request_.kept) {
      auto kept = std::make_unique<KeptPlane>(std::move(own_stream), device);
      kept->triangles = std::move(triangles);
      if (!wants_triangles()) {
        diagram->hand_over(*kept);
        order.hand_over(*kept);
        kept->cell_offsets = cells.take_offsets();
      }
      return tell_kept(std::move(kept), diagram->sizes());
    }
    place_rough(diagram->rough());
    team_.meet();
    if (member == 0)
      caller_.ask([&](const DiagramCaller& caller) { return caller.cut(caller.self, diagram->sizes()); });
  }

  /// The vertices that the processor places.
  void place_rough(const std::vector<int4>& vertices) {
    if (vertices.empty()) return;
    static_assert(sizeof(int4) == sizeof(RoughVertex));
    caller_.ask([&](const DiagramCaller& caller) {
      return caller.place(caller.self, reinterpret_cast<const RoughVertex*>(vertices.data()),
                          static_cast<std::int32_t>(vertices.size()));
    });
  }

  VisibleSites seen(const DeviceOrder& order, const double* weights, cudaStream_t stream) const {
    if (order.cell_count() != request_.count) throw LeftOver();
    VisibleSites visible(order, weights, stream);
    if (visible.count() < k_fewest) throw LeftOver();
    return visible;
  }

  /// Checks that the sites are on this device, and waits for whoever may still be writing them.
  void expect_sites_on(int device) const {
    cudaPointerAttributes attributes{};
    check_cuda(cudaPointerGetAttributes(&attributes, request_.sites), "looking for the sites");
    if (attributes.type != cudaMemoryTypeManaged && attributes.device != device)
      throw std::runtime_error("the sites are on device " + std::to_string(attributes.device) + ", not on " +
                               std::to_string(device));
    check_cuda(cudaDeviceSynchronize(), "waiting for the sites");
  }

  /// A number for each site; there when the stream has run.
  template <class Number, class Report>
  DeviceBuffer<Number> upload(const Number* numbers, cudaStream_t stream, Report&& report) const {
    const auto count = static_cast<std::size_t>(request_.count);
    if (HostCopies::is_pinned(numbers)) return {std::span<const Number>(numbers, count), stream};
    DeviceBuffer<Number> result(count, stream);
    HostCopies copies(stream);
    copies.to_device(numbers, count, result.data());
    copies.finish(report);
    return result;
  }

  /// Keeps what stays, and its stream, which outlive all else.
  void tell_kept(std::unique_ptr<KeptPlane> kept, const DiagramSizes& sizes) const {
    check_cuda(cudaStreamSynchronize(*kept->stream), "waiting for the device");
    *request_.kept = {kept.get(),
                      sizes.cells,
                      2 * sizes.edges,
                      sizes.edges,
                      sizes.vertices,
                      static_cast<std::int32_t>(kept->triangles.size() / 3),
                      kept->site_of.data(),
                      kept->cell_places.data(),
                      kept->cell_sites.data(),
                      kept->cell_offsets.data(),
                      kept->corner_vertices.data(),
                      kept->side_edges.data(),
                      reinterpret_cast<const std::int32_t*>(kept->edges.data()),
                      reinterpret_cast<const std::int32_t*>(kept->edge_sites.data()),
                      reinterpret_cast<const double*>(kept->vertices.data()),
                      kept->triangles.data()};
    kept.release();
  }

  DeviceOrder ordered(int member, const double2* sites, cudaStream_t stream) {
    DeviceOrder order(request_.count, stream);
    const IndexRange share = wants_triangles() ? IndexRange{0, 0} : share_of(member, request_.count);
    const DeviceOrder::Found found = order.find(sites, share, [&](std::uint32_t* places, std::int32_t* sorted) {
      if (request_.sites_are_there) throw LeftOver();
      caller_.ask([&](const DiagramCaller& caller) { return caller.sort(caller.self, places, sorted); });
    });
    if (found == DeviceOrder::Found::not_for_the_device || order.cell_count() < k_fewest) throw LeftOver();
    return order;
  }

  void make_room(std::int32_t cells) {
    const DiagramSizes most{cells, 3 * cells - 3, 2 * cells};
    caller_.ask([&](const DiagramCaller& caller) { return caller.make_room(caller.self, most, &to_); });
  }

  IndexRange share_of(int member, std::int32_t count) const {
    const auto begin = [&](std::int64_t i) { return static_cast<std::int32_t>(count * i / team_.members()); };
    return {begin(member), begin(member + 1)};
  }

  /// Each member copies its share, while cells are found.
  void copy_sites(const DeviceOrder& order, const CellSites& sites, const PlanePart& part, HostCopies& copies) const {
    const auto copy = [&](const auto* from, std::int32_t count, auto* to) {
      const IndexRange share = share_of(part.member, count);
      copies.to_host(from + share.begin, static_cast<std::size_t>(share.count()), to ? to + share.begin : to,
                     sites.are_there);
    };
    copy(sites.given, request_.count, reinterpret_cast<double2*>(to_.sites));
    copy(order.site_of(), request_.count, to_.site_of);
    copy(sites.cell_places, request_.count, to_.cell_places);
    copy(sites.original, sites.count, to_.cell_sites);
  }

  static constexpr std::int32_t k_fewest = 3;
  const DiagramRequest& request_;
  DeviceTeam team_;
  TeamCaller<DiagramCaller> caller_;
  TeamArrays arrays_;
  std::vector<DeviceTimes> times_;
  DiagramArrays to_{};
};

}  // namespace

CudaStatus find_voronoi_on_device(const DiagramRequest& request, const DiagramCaller& caller, DeviceTimes& times,
                                  CudaReason& reason) {
  return cuda_status(reason, [&] { times = Builder(request, caller).build(); });
}

void drop_voronoi_on_device(KeptPlane* kept) {
  if (cudaSetDevice(kept->device) != cudaSuccess) (void)cudaGetLastError();
  delete kept;
}

CudaStatus copy_back_from_device(int device, const void* from, void* to, std::uint64_t bytes, CudaReason& reason) {
  return cuda_status(reason, [&] {
    check_cuda(cudaSetDevice(device), "choosing the device");
    const Stream stream;
    HostCopies copies(stream);
    copies.to_host(static_cast<const char*>(from), static_cast<std::size_t>(bytes), to);
    copies.finish();
  });
}

}  // namespace saddleback
