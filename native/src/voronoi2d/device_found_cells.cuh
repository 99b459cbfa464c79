#pragma once
// Cells as they are found, by all or a part of the sites: first those of many sites at once, then one by one those that
// took other means.

#include <vector>

#include "support/device_stream.h"
#include "voronoi2d/device_far_cells.cuh"
#include "voronoi2d/device_numbering.cuh"
#include "voronoi2d/device_weighted_cells.cuh"
#include "voronoi2d/device_weighted_far_cells.cuh"

namespace saddleback::voronoi2d {
namespace {

inline int blocks_of(const void* kernel, int threads, std::size_t shared, int device) {
  int per_processor = 0, processors = 0;
  check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&per_processor, kernel, threads, shared),
             "asking for occupancy");
  check_cuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device),
             "asking for the number of processors");
  return std::max(1, per_processor) * processors;
}

/// The neighbours of the cells, of which every member of a team finds a part.
class FoundCells {
 public:
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

 protected:
  FoundCells(std::int32_t count, cudaStream_t stream)
      : stream_(stream),
        count_(count),
        slots_(static_cast<std::size_t>(count_) * k_slots, stream),
        counts_(static_cast<std::size_t>(count_) + 1, stream),
        offsets_(static_cast<std::size_t>(count_) + 1, stream),
        far_(static_cast<std::size_t>(count_), stream),
        failed_(static_cast<std::size_t>(k_most_failures) + 4096, stream),
        pool_(static_cast<std::size_t>(count_) / 4 + 65536, stream),
        is_open_(static_cast<std::size_t>(count_), stream),
        counters_(5, stream) {}

  void begin() {
    counts_.fill_bytes(0);
    counters_.fill_bytes(0);
  }
  int* next() { return counters_.data() + k_next; }  ///< of tiles, or whatever cells are found by
  /// Calls kernel(far cells, how many, counter of those taken, where others fail and how often) for those left.
  template <class Kernel>
  void find_others(Kernel&& kernel) {
    DeviceLists failing = lists();
    failing.far = failed_.data();
    kernel(FarCells{far_.data(), counters_.data() + k_far, counters_.data() + k_next_far, counters_.data() + k_failed,
                    k_most_failures},
           failing);
    check_cuda(cudaGetLastError(), "finding far cells");
  }

  cudaStream_t stream_;
  std::int32_t count_;

 private:
  enum { k_next, k_far, k_next_far, k_failed, k_pool, k_counters };
  static constexpr int k_most_failures = 64;
  DeviceBuffer<std::int32_t> slots_, counts_, offsets_, far_, failed_, pool_;
  DeviceBuffer<std::uint8_t> is_open_;
  DeviceBuffer<int> counters_;
};

/// The cells of sites without weights.
class CellFinder : public FoundCells {
 public:
  CellFinder(const DeviceOrder& order, int members, cudaStream_t stream)
      : FoundCells(order.cell_count(), stream),
        order_(order),
        tiles_(order.places(), count_, stream),
        parts_(tiles_.parts(members, count_)) {}

  /// Where the members' cells begin, and the last one's end.
  const std::vector<std::int32_t>& begins() const { return parts_.sites; }

  /// Does not wait for the last tiles; calls report() in between where there are many.
  template <class Report>
  void start(int member, int device, Report&& report) {
    const BoxLevels boxes(order_.at(), count_, stream_);
    const auto at = static_cast<std::size_t>(member);
    const std::int32_t sites = parts_.sites[at + 1] - parts_.sites[at];
    begin();
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
      const TileRange range{tiles_.begins(), tiles_.count(), next(), first,
                            is_last ? last : first + k_tiles_per_launch};
      check_cuda(cudaMemsetAsync(range.taken, 0, sizeof(int), stream_), "clearing a counter");
      find_cells_of_tiles<<<blocks, k_tile_threads, k_shared, stream_>>>(boxes.tree(), range, lists());
      check_cuda(cudaGetLastError(), "finding cells");
      if (is_last) break;
      check_cuda(cudaStreamSynchronize(stream_), "finding cells");
      report(static_cast<double>(i) / launches);
    }
    const int far_blocks = blocks_of(reinterpret_cast<const void*>(find_far_cells), k_far_threads, 0, device);
    find_others([&](const FarCells& far, const DeviceLists& to) {
      find_far_cells<<<far_blocks, k_far_threads, 0, stream_>>>(boxes.tree(), far, to);
    });
  }

 private:
  const DeviceOrder& order_;
  const Tiles tiles_;
  const Tiles::Parts parts_;
};

/// Those of weighted sites.
class WeightedCellFinder : public FoundCells {
 public:
  WeightedCellFinder(const VisibleSites& sites, int members, cudaStream_t stream)
      : FoundCells(sites.count(), stream), boxes_(sites.at(), sites.weights(), sites.count(), stream) {
    const std::int64_t rows = boxes_.tree().boxes.counts[0];
    for (int i = 0; i < members; ++i) begins_.push_back(static_cast<std::int32_t>(rows * i / members * 32));
    begins_.push_back(count_);
  }
  const std::vector<std::int32_t>& begins() const { return begins_; }

  template <class Report>
  void start(int member, int device, Report&& report) {
    begin();
    const auto at = static_cast<std::size_t>(member);
    const int blocks = blocks_of(reinterpret_cast<const void*>(find_weighted_cells), k_row_threads, 0, device);
    constexpr std::int32_t k_rows_per_launch = 1 << 15;  // some milliseconds
    const IndexRange rows{begins_[at] / 32, (begins_[at + 1] + 31) / 32};
    for (std::int32_t first = rows.begin; first < rows.end; first += k_rows_per_launch) {
      const IndexRange some{first, std::min(rows.end, first + k_rows_per_launch)};
      check_cuda(cudaMemsetAsync(next(), 0, sizeof(int), stream_), "clearing a counter");
      find_weighted_cells<<<blocks, k_row_threads, 0, stream_>>>(boxes_.tree(), some, next(), lists());
      check_cuda(cudaGetLastError(), "finding cells");
      if (some.end == rows.end) break;
      check_cuda(cudaStreamSynchronize(stream_), "finding cells");
      report(static_cast<double>(some.end - rows.begin) / rows.count());
    }
    const int far_blocks = blocks_of(reinterpret_cast<const void*>(find_far_weighted_cells), k_far_threads, 0, device);
    find_others([&](const FarCells& far, const DeviceLists& to) {
      find_far_weighted_cells<<<far_blocks, k_far_threads, 0, stream_>>>(boxes_.tree(), far, to);
    });
  }

 private:
  const WeightedBoxes boxes_;
  std::vector<std::int32_t> begins_;
};

}  // namespace
}  // namespace saddleback::voronoi2d
