// Voronoi diagrams of the plane on a CUDA device: order, cells by tiles, cells that these could not tell, numbers. The
// answer is the processor's, to the bit.

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "support/device_stream.h"
#include "support/host_copies.h"
#include "voronoi2d/device_far_cells.cuh"
#include "voronoi2d/device_numbering.cuh"
#include "voronoi2d/device_voronoi.h"

namespace saddleback {
namespace {

using namespace voronoi2d;

int blocks_of(const void* kernel, int threads, std::size_t shared, int device) {
  int per_processor = 0, processors = 0;
  check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&per_processor, kernel, threads, shared),
             "asking for occupancy");
  check_cuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device),
             "asking for the number of processors");
  return std::max(1, per_processor) * processors;
}

/// The neighbours of a part of the cells.
class CellFinder {
 public:
  CellFinder(const DeviceOrder& order, int members, cudaStream_t stream)
      : stream_(stream),
        count_(order.cell_count()),
        order_(order),
        tiles_(order.places(), count_, stream),
        parts_(tiles_.parts(members, count_)),
        slots_(static_cast<std::size_t>(count_) * k_slots, stream),
        counts_(static_cast<std::size_t>(count_) + 1, stream),
        offsets_(static_cast<std::size_t>(count_) + 1, stream),
        far_(static_cast<std::size_t>(count_), stream),
        failed_(static_cast<std::size_t>(k_most_failures) + 4096, stream),
        pool_(static_cast<std::size_t>(count_) / 4 + 65536, stream),
        is_open_(static_cast<std::size_t>(count_), stream),
        counters_(5, stream) {}

  /// Where the members' cells begin, and the last one's end.
  const std::vector<std::int32_t>& begins() const { return parts_.sites; }

  /// Does not wait for the last tiles; calls report() in between where there are many.
  template <class Report>
  void start(int member, int device, Report&& report) {
    const BoxLevels boxes(order_.at(), count_, stream_);
    const auto at = static_cast<std::size_t>(member);
    const std::int32_t sites = parts_.sites[at + 1] - parts_.sites[at];
    counts_.fill_bytes(0);
    counters_.fill_bytes(0);
    constexpr std::size_t k_shared = sizeof(TileMemory);
    check_cuda(cudaFuncSetAttribute(find_cells_of_tiles, cudaFuncAttributeMaxDynamicSharedMemorySize, k_shared),
               "asking for shared memory");
    check_cuda(cudaFuncSetAttribute(find_cells_of_tiles, cudaFuncAttributePreferredSharedMemoryCarveout, 100),
               "asking for shared memory");
    const int blocks = blocks_of(reinterpret_cast<const void*>(find_cells_of_tiles), k_tile_threads, k_shared, device);
    constexpr std::int32_t k_tiles_per_launch = 1 << 17;  // some tens of milliseconds
    // Of one part the number of tiles is not known here: they are half full and less.
    const std::int32_t launches = 1 + sites / (k_tile_sites * k_tiles_per_launch) * 4, last = parts_.tiles[at + 1];
    for (std::int32_t i = 0; i < launches; ++i) {
      const std::int32_t first = parts_.tiles[at] + i * k_tiles_per_launch;
      const bool is_last = i + 1 == launches || last - first <= k_tiles_per_launch;
      const TileRange range{tiles_.begins(), tiles_.count(), counters_.data() + k_next_tile, first,
                            is_last ? last : first + k_tiles_per_launch};
      check_cuda(cudaMemsetAsync(range.taken, 0, sizeof(int), stream_), "clearing a counter");
      find_cells_of_tiles<<<blocks, k_tile_threads, k_shared, stream_>>>(boxes.tree(), range, lists());
      check_cuda(cudaGetLastError(), "finding cells");
      if (is_last) break;
      check_cuda(cudaStreamSynchronize(stream_), "finding cells");
      report(static_cast<double>(i) / launches);
    }
    const int far_blocks = blocks_of(reinterpret_cast<const void*>(find_far_cells), k_far_threads, 0, device);
    DeviceLists far_lists = lists();
    far_lists.far = failed_.data();
    find_far_cells<<<far_blocks, k_far_threads, 0, stream_>>>(boxes.tree(), far_.data(), counters_.data() + k_far,
                                                              counters_.data() + k_next_far, far_lists,
                                                              counters_.data() + k_failed, k_most_failures);
    check_cuda(cudaGetLastError(), "finding far cells");
  }

  /// All members' cells, where there are several.
  void share(const PlanePart& part) {
    part.arrays.share(part.member, counts_.data(), part.begins, stream_);
    part.arrays.share(part.member, is_open_.data(), part.begins, stream_);
    add_up(counts_, offsets_, stream_);  // the last count is 0
  }

  /// Waits for the cells. \return how many neighbours all have together.
  std::int32_t finish(DeviceTimes& times) const {
    int counters[k_counters];
    std::int32_t sides = 0;
    check_cuda(cudaMemcpyAsync(&sides, offsets_.data() + count_, sizeof sides, cudaMemcpyDeviceToHost, stream_),
               "counting sides");
    counters_.read(counters);
    times.second_pass = counters[k_far];
    if (counters[k_failed] > 0) throw LeftOver();
    return sides;
  }
  const DeviceBuffer<std::int32_t>& offsets() const { return offsets_; }
  DeviceBuffer<std::int32_t> take_offsets() { return std::move(offsets_); }

  DeviceLists lists() {
    return {slots_.data(),
            counts_.data(),
            is_open_.data(),
            pool_.data(),
            reinterpret_cast<unsigned*>(counters_.data() + k_pool),
            static_cast<unsigned>(pool_.size()),
            far_.data(),
            counters_.data() + k_far};
  }

 private:
  enum { k_next_tile, k_far, k_next_far, k_failed, k_pool, k_counters };
  static constexpr int k_most_failures = 64;
  cudaStream_t stream_;
  std::int32_t count_;
  const DeviceOrder& order_;
  const Tiles tiles_;
  const Tiles::Parts parts_;
  DeviceBuffer<std::int32_t> slots_, counts_, offsets_, far_, failed_, pool_;
  DeviceBuffer<std::uint8_t> is_open_;
  DeviceBuffer<int> counters_;
};

/// What a diagram takes at most at once, in bytes.
std::uint64_t bytes_needed(std::int32_t count) { return static_cast<std::uint64_t>(count) * 360 + (1 << 20); }

/// A diagram found by one or several devices. All have all sites, each finds and numbers the cells of some tiles.
class Builder {
 public:
  Builder(const PlaneTwinRequest& request, const PlaneTwinCaller& caller)
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
  void build_part(int member) {
    const int device = team_.device(member);
    check_cuda(cudaSetDevice(device), "choosing the device");
    check_device_room("the diagram", bytes_needed(request_.count), request_.most_bytes);
    keep_freed_memory(device);
    const auto report = [&](double fraction) { caller_.report(member, fraction); };
    DeviceTimes& times = times_[static_cast<std::size_t>(member)];
    auto own_stream = std::make_unique<Stream>();
    const cudaStream_t stream = *own_stream;
    Stopwatch watch(stream);
    DeviceBuffer<double2> uploaded;
    if (request_.sites_are_there) {
      expect_sites_on(device);
    } else {
      uploaded = upload(stream, report);
    }
    times.upload = watch.lap();
    report(0.1);
    DeviceOrder order =
        ordered(request_.sites_are_there ? reinterpret_cast<const double2*>(request_.sites) : uploaded.data(), stream);
    times.order = watch.lap();
    report(0.2);
    CellFinder cells(order, team_.members(), stream);
    const PlanePart part{arrays_, member, cells.begins()};
    cells.start(member, device, [&](double done) { report(0.2 + 0.3 * done); });
    cells.share(part);
    watch.end();
    if (member == 0 && !request_.kept) make_room(order.cell_count());
    team_.meet();
    HostCopies copies(stream);
    copy_order(order, part, copies);
    const std::int32_t sides = cells.finish(times);
    times.find = watch.read();
    report(0.6);
    watch.start();
    DeviceDiagram diagram(part, order.cell_count(), sides, stream);
    if (!diagram.can_be()) throw LeftOver();
    const HostCopies::End end(copies);
    if (member == 0)
      copies.to_host(cells.offsets().data(), static_cast<std::size_t>(order.cell_count()) + 1, to_.cell_offsets);
    const DeviceCells rows{order.cell_count(),     part.cells(),         order.at(),           order.original(),
                           cells.offsets().data(), diagram.neighbours(), cells.lists().is_open};
    diagram.join(rows, cells.offsets(), cells.lists());
    DeviceBuffer<std::int32_t> triangles;
    if (request_.kept && request_.only_triangles) {
      triangles = diagram.triangles(rows);
    } else {
      diagram.number(rows, copies, to_);
    }
    times.unite = watch.lap();
    report(0.7);
    copies.finish([&] { report(0.7); });
    if (!diagram.fits()) throw LeftOver();
    times.download = watch.lap();
    if (request_.kept) {
      auto kept = std::make_unique<KeptPlane>(std::move(own_stream), device);
      kept->triangles = std::move(triangles);
      if (!request_.only_triangles) {
        diagram.hand_over(*kept);
        order.hand_over(*kept);
        kept->cell_offsets = cells.take_offsets();
      }
      return tell_kept(std::move(kept), diagram.sizes());
    }
    team_.meet();
    if (member == 0)
      caller_.ask([&](const PlaneTwinCaller& caller) { return caller.cut(caller.self, diagram.sizes()); });
  }

  /// Whoever wrote them there may still be at it.
  void expect_sites_on(int device) const {
    cudaPointerAttributes attributes{};
    check_cuda(cudaPointerGetAttributes(&attributes, request_.sites), "looking for the sites");
    if (attributes.type != cudaMemoryTypeManaged && attributes.device != device)
      throw std::runtime_error("the sites are on device " + std::to_string(attributes.device) + ", not on " +
                               std::to_string(device));
    check_cuda(cudaDeviceSynchronize(), "waiting for the sites");
  }

  template <class Report>
  DeviceBuffer<double2> upload(cudaStream_t stream, Report&& report) const {
    const auto count = static_cast<std::size_t>(request_.count);
    DeviceBuffer<double2> sites(count, stream);
    HostCopies copies(stream);
    copies.to_device(reinterpret_cast<const double2*>(request_.sites), count, sites.data());
    copies.finish([&] { report(0); });
    return sites;
  }

  /// What stays, and its stream, outlive all else.
  void tell_kept(std::unique_ptr<KeptPlane> kept, const PlaneTwinSizes& sizes) const {
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

  DeviceOrder ordered(const double2* sites, cudaStream_t stream) {
    DeviceOrder order(request_.count, stream);
    const DeviceOrder::Found found = order.find(sites, [&](std::uint32_t* places, std::int32_t* sorted) {
      if (request_.sites_are_there) throw LeftOver();
      caller_.ask([&](const PlaneTwinCaller& caller) { return caller.sort(caller.self, places, sorted); });
    });
    constexpr std::int32_t k_fewest = 3;
    if (found == DeviceOrder::Found::not_for_the_device || order.cell_count() < k_fewest) throw LeftOver();
    return order;
  }

  void make_room(std::int32_t cells) {
    const PlaneTwinSizes most{cells, 3 * cells - 3, 2 * cells};
    caller_.ask([&](const PlaneTwinCaller& caller) { return caller.make_room(caller.self, most, &to_); });
  }

  /// Each member copies its share.
  void copy_order(const DeviceOrder& order, const PlanePart& part, HostCopies& copies) const {
    const auto copy = [&](const std::int32_t* from, std::int32_t count, std::int32_t* to) {
      const auto begin = static_cast<std::ptrdiff_t>(static_cast<std::int64_t>(count) * part.member / team_.members());
      const auto end =
          static_cast<std::ptrdiff_t>(static_cast<std::int64_t>(count) * (part.member + 1) / team_.members());
      copies.to_host(from + begin, static_cast<std::size_t>(end - begin), to ? to + begin : to);
    };
    copy(order.site_of(), request_.count, to_.site_of);
    copy(order.cell_places(), request_.count, to_.cell_places);
    copy(order.original(), order.cell_count(), to_.cell_sites);
  }

  const PlaneTwinRequest& request_;
  DeviceTeam team_;
  TeamCaller<PlaneTwinCaller> caller_;
  TeamArrays arrays_;
  std::vector<DeviceTimes> times_;
  PlaneTwinArrays to_{};
};

}  // namespace

TwinStatus find_voronoi_on_device(const PlaneTwinRequest& request, const PlaneTwinCaller& caller, DeviceTimes& times,
                                  TwinReason& reason) {
  return twin_status(reason, [&] { times = Builder(request, caller).build(); });
}

void drop_voronoi_on_device(KeptPlane* kept) {
  if (cudaSetDevice(kept->device) != cudaSuccess) (void)cudaGetLastError();
  delete kept;
}

TwinStatus copy_back_from_device(int device, const void* from, void* to, std::uint64_t bytes, TwinReason& reason) {
  return twin_status(reason, [&] {
    check_cuda(cudaSetDevice(device), "choosing the device");
    const Stream stream;
    HostCopies copies(stream);
    copies.to_host(static_cast<const char*>(from), static_cast<std::size_t>(bytes), to);
    copies.finish();
  });
}

}  // namespace saddleback
