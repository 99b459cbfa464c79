// Voronoi diagrams of the plane on a CUDA device: order, cells by tiles, cells that these could not tell, numbers. The
// answer is the processor's, to the bit.

#include <limits>
#include <vector>

#include "support/device_stream.h"
#include "support/host_copies.h"
#include "voronoi2d/device_far_cells.cuh"
#include "voronoi2d/device_numbering.cuh"
#include "voronoi2d/device_voronoi.h"

namespace saddleback {
namespace {

using namespace voronoi2d;

/// The processor had better do it.
struct LeftOver {};

int blocks_of(const void* kernel, int threads, std::size_t shared, int device) {
  int per_processor = 0, processors = 0;
  check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&per_processor, kernel, threads, shared),
             "asking for occupancy");
  check_cuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device),
             "asking for the number of processors");
  return std::max(1, per_processor) * processors;
}

/// The neighbours of all cells.
class CellFinder {
 public:
  CellFinder(std::int32_t count, cudaStream_t stream)
      : stream_(stream),
        count_(count),
        slots_(static_cast<std::size_t>(count) * k_slots, stream),
        counts_(static_cast<std::size_t>(count) + 1, stream),
        offsets_(static_cast<std::size_t>(count) + 1, stream),
        far_(static_cast<std::size_t>(count), stream),
        failed_(static_cast<std::size_t>(k_most_failures) + 4096, stream),
        pool_(static_cast<std::size_t>(count) / 4 + 65536, stream),
        is_open_(static_cast<std::size_t>(count), stream),
        counters_(5, stream) {}

  /// Does not wait for the last tiles; calls report() in between where there are many.
  template <class Report>
  void start(const DeviceOrder& order, int device, Report&& report) {
    const BoxLevels boxes(order.at(), count_, stream_);
    const Tiles tiles(order.places(), count_, stream_);
    counts_.fill_bytes(0);
    counters_.fill_bytes(0);
    constexpr std::size_t k_shared = sizeof(TileMemory);
    check_cuda(cudaFuncSetAttribute(find_cells_of_tiles, cudaFuncAttributeMaxDynamicSharedMemorySize, k_shared),
               "asking for shared memory");
    check_cuda(cudaFuncSetAttribute(find_cells_of_tiles, cudaFuncAttributePreferredSharedMemoryCarveout, 100),
               "asking for shared memory");
    const int blocks = blocks_of(reinterpret_cast<const void*>(find_cells_of_tiles), k_tile_threads, k_shared, device);
    constexpr std::int32_t k_tiles_per_launch = 1 << 17;                                 // some tens of milliseconds
    const std::int32_t launches = 1 + count_ / (k_tile_sites * k_tiles_per_launch) * 4;  // tiles are half full and less
    for (std::int32_t i = 0; i < launches; ++i) {
      const TileRange range{tiles.begins(), tiles.count(), counters_.data() + k_next_tile, i * k_tiles_per_launch,
                            i + 1 < launches ? (i + 1) * k_tiles_per_launch : std::numeric_limits<std::int32_t>::max()};
      check_cuda(cudaMemsetAsync(range.taken, 0, sizeof(int), stream_), "clearing a counter");
      find_cells_of_tiles<<<blocks, k_tile_threads, k_shared, stream_>>>(boxes.tree(), range, lists());
      check_cuda(cudaGetLastError(), "finding cells");
      if (i + 1 == launches) break;
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
    add_up(counts_, offsets_, stream_);  // the last count is 0
  }

  /// Waits for the cells. \return how many neighbours they have together.
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
  const std::int32_t* offsets() const { return offsets_.data(); }

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
  DeviceBuffer<std::int32_t> slots_, counts_, offsets_, far_, failed_, pool_;
  DeviceBuffer<std::uint8_t> is_open_;
  DeviceBuffer<int> counters_;
};

/// What a diagram takes at most at once, in bytes.
std::uint64_t bytes_needed(std::int32_t count) { return static_cast<std::uint64_t>(count) * 360 + (1 << 20); }

class Builder {
 public:
  Builder(const PlaneTwinRequest& request, const PlaneTwinCaller& caller, DeviceTimes& times)
      : request_(request), caller_(caller), times_(times) {}

  void build() {
    check_cuda(cudaSetDevice(request_.device), "choosing the device");
    check_device_room("the diagram", bytes_needed(request_.count), request_.most_bytes);
    keep_freed_memory(request_.device);
    const Stream stream;
    Stopwatch watch(stream);
    const auto count = static_cast<std::size_t>(request_.count);
    const DeviceBuffer<double2> sites = upload(stream);
    times_.upload = watch.lap();
    report(0.1);
    DeviceOrder order(request_.count, stream);
    switch (order.find(sites.data(), caller_)) {
      case DeviceOrder::Found::order:
        break;
      case DeviceOrder::Found::not_for_the_device:
        throw LeftOver();
      case DeviceOrder::Found::stopped:
        throw Stopped();
    }
    times_.order = watch.lap();
    report(0.2);
    constexpr std::int32_t k_fewest = 3;
    if (order.cell_count() < k_fewest) throw LeftOver();
    CellFinder cells(order.cell_count(), stream);
    cells.start(order, request_.device, [&](double done) { report(0.2 + 0.3 * done); });
    watch.end();
    const PlaneTwinSizes most{order.cell_count(), 3 * order.cell_count() - 3, 2 * order.cell_count()};
    PlaneTwinArrays to{};
    if (!caller_.make_room(caller_.self, most, &to)) throw Stopped();
    HostCopies copies(stream);
    copies.to_host(order.site_of(), count, to.site_of);
    copies.to_host(order.cell_places(), count, to.cell_places);
    copies.to_host(order.original(), static_cast<std::size_t>(order.cell_count()), to.cell_sites);
    const std::int32_t sides = cells.finish(times_);
    times_.find = watch.read();
    report(0.6);
    watch.start();
    DeviceDiagram diagram(order.cell_count(), sides, stream);
    if (!diagram.can_be()) throw LeftOver();
    const HostCopies::End end(copies);
    copies.to_host(cells.offsets(), static_cast<std::size_t>(order.cell_count()) + 1, to.cell_offsets);
    diagram.number({order.cell_count(), order.at(), order.original(), cells.offsets(), diagram.neighbours(),
                    cells.lists().is_open},
                   cells.lists(), copies, to);
    times_.unite = watch.lap();
    report(0.7);
    copies.finish([&] { report(0.7); });
    if (!diagram.fits()) throw LeftOver();
    times_.download = watch.lap();
    if (!caller_.cut(caller_.self, diagram.sizes())) throw Stopped();
  }

 private:
  DeviceBuffer<double2> upload(cudaStream_t stream) const {
    const auto count = static_cast<std::size_t>(request_.count);
    DeviceBuffer<double2> sites(count, stream);
    HostCopies copies(stream);
    copies.to_device(reinterpret_cast<const double2*>(request_.sites), count, sites.data());
    copies.finish([&] { report(0); });
    return sites;
  }
  void report(double fraction) const {
    if (!caller_.keep_going(caller_.self, fraction)) throw Stopped();
  }

  const PlaneTwinRequest& request_;
  const PlaneTwinCaller& caller_;
  DeviceTimes& times_;
};

}  // namespace

TwinStatus find_voronoi_on_device(const PlaneTwinRequest& request, const PlaneTwinCaller& caller, DeviceTimes& times,
                                  TwinReason& reason) {
  try {
    Builder(request, caller, times).build();
    return TwinStatus::done;
  } catch (const Stopped&) {
    return TwinStatus::stopped;
  } catch (const LeftOver&) {
    return TwinStatus::left;
  } catch (const std::exception& failure) {
    reason = failure.what();
    return TwinStatus::failed;
  }
}

}  // namespace saddleback
