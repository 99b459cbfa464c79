#pragma once
// Cells as they are found, by all or a part of the sites: first those of many sites at once, then one by one those that
// took other means; all in another way where these are many.

#include <limits>
#include <vector>

#include "support/cuda/device_stream.h"
#include "voronoi2d/cuda/device_far_cells.cuh"
#include "voronoi2d/cuda/device_merged_cells.cuh"
#include "voronoi2d/cuda/device_numbering.cuh"
#include "voronoi2d/cuda/device_weighted_cells.cuh"
#include "voronoi2d/cuda/device_weighted_far_cells.cuh"

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

/// The neighbors of the cells, of which every member of a team finds a part.
class FoundCells {
 public:
  /// Shares how many neighbors all members' cells have, where there are several.
  void share(const PlanePart& part) { part.add_up_all(counts_, offsets_, stream_); }  // the last count is 0

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
        counters_(k_counters, stream) {}

  void begin() {
    counts_.fill_bytes(0);
    counters_.fill_bytes(0);
  }
  void add_sides() { add_up(counts_, offsets_, stream_); }

  struct Count {
    int far, failed;
    bool are_left;
    std::int32_t sides;
  };
  /// Counts what was started before: waits for it, and calls report(share done of the last cells) now and then, which
  /// may throw.
  template <class Report>
  Count count(Report&& report) {
    int counters[k_counters];
    wait_polling(
        stream_,
        [&](cudaStream_t aside) {
          check_cuda(cudaMemcpyAsync(counters, counters_.data(), sizeof counters, cudaMemcpyDeviceToHost, aside),
                     "counting cells");
          check_cuda(cudaStreamSynchronize(aside), "counting cells");
          report(std::min(1.0, static_cast<double>(counters[k_next_far]) / std::max(1, counters[k_far])));
        },
        [&](cudaStream_t aside) {  // as if all were left to other means
          (void)cudaMemsetAsync(counters_.data() + k_left, 1, sizeof(int), aside);
        });
    std::int32_t sides = 0;
    check_cuda(cudaMemcpyAsync(&sides, offsets_.data() + count_, sizeof sides, cudaMemcpyDeviceToHost, stream_),
               "counting sides");
    counters_.read(counters);
    return {counters[k_far], counters[k_failed], counters[k_left] != 0, sides};
  }

  /// \return how many neighbors all have together.
  static std::int32_t settle(const Count& found, DeviceTimes& times) {
    times.second_pass = found.far;
    if (found.failed > 0) throw LeftOver();
    return found.sides;
  }

  void make_pool(std::size_t size) { pool_ = DeviceBuffer<std::int32_t>(size, stream_); }
  int* next() { return counters_.data() + k_next; }  ///< of tiles, or whatever cells are found by
  int* are_left() { return counters_.data() + k_left; }
  /// Calls kernel(far cells, how many, counter of those taken, where others fail and how often) for those left, if not
  /// all are.
  template <class Kernel>
  void find_others(Kernel&& kernel) {
    DeviceLists failing = lists();
    failing.far = failed_.data();
    kernel(FarCells{far_.data(), counters_.data() + k_far, are_left(), counters_.data() + k_next_far,
                    counters_.data() + k_failed, k_most_failures},
           failing);
    check_cuda(cudaGetLastError(), "finding far cells");
  }

  cudaStream_t stream_;
  std::int32_t count_;

 private:
  enum { k_next, k_far, k_next_far, k_failed, k_pool, k_left, k_counters };
  static constexpr int k_most_failures = 64;
  DeviceBuffer<std::int32_t> slots_, counts_, offsets_, far_, failed_, pool_;
  DeviceBuffer<std::uint8_t> is_open_;
  DeviceBuffer<int> counters_;
};

/// The cells of sites without weights.
class CellFinder : public FoundCells {
 public:
  /// `may_be_left`: whether the processor can do what would take longer here.
  CellFinder(const DeviceOrder& order, int member, int members, bool may_be_left, cudaStream_t stream)
      : FoundCells(order.cell_count(), stream),
        order_(order),
        tiles_(order.places(), count_, member, members, stream),
        member_(static_cast<std::size_t>(member)),
        may_be_left_(may_be_left) {}

  /// Returns where the members' cells begin, and the last one's end.
  const std::vector<std::int32_t>& begins() const { return tiles_.bounds(); }

  /// Does not wait for the last cells; calls report(share done) in between where there are many.
  template <class Report>
  void start(int device, Report&& report) {
    device_ = device;
    constexpr int k_many = 32;  // of as many one
    find(mine().count() / k_many, report);
  }
  /// Does the same where others wait for these cells: waits for all of them. Calls meanwhile() before, and undo() when
  /// what that did needs memory that is wanted.
  template <class Report, class Meanwhile, class Undo>
  void start(int device, Report&& report, Meanwhile&& meanwhile, Undo&& undo) {
    start(device, report);
    meanwhile();
    const Count found = count(of_last(report));
    if (!found.are_left) return;
    undo();
    find_left(found, report);
  }

  /// Waits for the cells. \return how many neighbors all have together.
  template <class Report>
  std::int32_t finish(DeviceTimes& times, Stopwatch& watch, Report&& report) {
    Count found = count(of_last(report));
    if (begins().size() == 2 && find_left(found, report)) {
      add_sides();
      watch.end();
      found = count(of_last(report));
      found.far = std::max(found.far, count_);
    }
    return settle(found, times);
  }

 private:
  /// Measures shares of all time: until the tiles are done.
  static constexpr double k_tiles = 0.9;
  template <class Report>
  static auto of_last(Report& report) {
    return [&report](double done) { report(k_tiles + (1 - k_tiles) * done); };
  }

  IndexRange mine() const { return {begins()[member_], begins()[member_ + 1]}; }

  /// Leaves all to other means where there are more cells than `most_far`, and many of those so far, that tiles cannot
  /// tell: the sites are not such as tiles are made for.
  template <class Report>
  void find(int most_far, Report&& report) {
    const BoxLevels boxes(order_.at(), count_, stream_);
    begin();
    constexpr std::size_t k_shared = sizeof(TileMemory);
    check_cuda(cudaFuncSetAttribute(find_cells_of_tiles, cudaFuncAttributeMaxDynamicSharedMemorySize, k_shared),
               "asking for shared memory");
    check_cuda(cudaFuncSetAttribute(find_cells_of_tiles, cudaFuncAttributePreferredSharedMemoryCarveout, 100),
               "asking for shared memory");
    const int blocks = blocks_of(reinterpret_cast<const void*>(find_cells_of_tiles), k_tile_threads, k_shared, device_);
    constexpr std::int32_t k_tiles_per_launch = 1 << 17;  // some tens of milliseconds
    // The number of tiles is not known here: they are half full and less.
    const std::int32_t launches = 1 + mine().count() / (k_tile_sites * k_tiles_per_launch) * 4;
    for (std::int32_t i = 0; i < launches; ++i) {
      const std::int32_t first = i * k_tiles_per_launch;
      const bool is_last = i + 1 == launches;
      constexpr std::int32_t k_all = std::numeric_limits<std::int32_t>::max();
      const TileRange range{
          tiles_.begins(), tiles_.count(), next(),    first, is_last ? k_all : first + k_tiles_per_launch,
          mine(),          most_far,       are_left()};
      check_cuda(cudaMemsetAsync(range.taken, 0, sizeof(int), stream_), "clearing a counter");
      find_cells_of_tiles<<<blocks, k_tile_threads, k_shared, stream_>>>(boxes.tree(), range, lists());
      check_cuda(cudaGetLastError(), "finding cells");
      if (is_last) break;
      check_cuda(cudaStreamSynchronize(stream_), "finding cells");
      report(k_tiles * i / launches);
    }
    const int far_blocks = blocks_of(reinterpret_cast<const void*>(find_far_cells), k_far_threads, 0, device_);
    find_others([&](const FarCells& far, const DeviceLists& to) {
      find_far_cells<<<far_blocks, k_far_threads, 0, stream_>>>(boxes.tree(), far, to);
    });
  }

  /// Finds all of them by other means where that was left. \return whether it was.
  template <class Report>
  bool find_left(const Count& found, Report& report) {
    if (!found.are_left) return false;
    const MergeOutcome merged = merge([&] { report(k_tiles); });
    if (merged == MergeOutcome::too_slow) throw LeftOver();
    if (merged == MergeOutcome::not_told) find(std::numeric_limits<int>::max(), report);
    return true;
  }

  template <class Poll>
  MergeOutcome merge(Poll&& poll) {
    if (count_ > std::numeric_limits<std::int32_t>::max() / (2 * MergedMesh::k_edges)) return MergeOutcome::not_told;
    begin();
    make_pool(6 * static_cast<std::size_t>(count_));  // as many neighbors as all have together
    // A merge is one lane's, which the processor outruns where it is long, as between two rings. Cell by cell takes
    // longer still.
    const int most_steps = may_be_left_ ? 1 << 17 : std::numeric_limits<int>::max() / 2;
    MergedSites sites(order_.at(), order_.places(), count_, most_steps, stream_);
    sites.merge(blocks_of(reinterpret_cast<const void*>(merge_far_sites), k_threads, 0, device_));
    // Several members number what lies between their cells in steps by the square of a cell's neighbors.
    constexpr int k_any = std::numeric_limits<int>::max(), k_most_shared = 1024;
    return sites.list(mine(), begins().size() == 2 ? k_any : k_most_shared, lists(), poll);
  }

  const DeviceOrder& order_;
  const Tiles tiles_;
  std::size_t member_ = 0;
  bool may_be_left_;
  int device_ = 0;
};

/// Finds the cells of weighted sites.
class WeightedCellFinder : public FoundCells {
 public:
  WeightedCellFinder(const VisibleSites& sites, int member, int members, cudaStream_t stream)
      : FoundCells(sites.count(), stream),
        boxes_(sites.at(), sites.weights(), sites.count(), stream),
        member_(static_cast<std::size_t>(member)) {
    const std::int64_t rows = boxes_.tree().boxes.counts[0];
    for (int i = 0; i < members; ++i) begins_.push_back(static_cast<std::int32_t>(rows * i / members * 32));
    begins_.push_back(count_);
  }
  const std::vector<std::int32_t>& begins() const { return begins_; }
  /// Waits for the cells. \return how many neighbors all have together.
  template <class Report>
  std::int32_t finish(DeviceTimes& times, Stopwatch&, Report&& report) {
    return settle(count([&](double done) { report(k_rows + (1 - k_rows) * done); }), times);
  }

  template <class Report>
  void start(int device, Report&& report) {
    begin();
    const int blocks = blocks_of(reinterpret_cast<const void*>(find_weighted_cells), k_row_threads, 0, device);
    constexpr std::int32_t k_rows_per_launch = 1 << 15;  // some milliseconds
    const IndexRange rows{begins_[member_] / 32, (begins_[member_ + 1] + 31) / 32};
    for (std::int32_t first = rows.begin; first < rows.end; first += k_rows_per_launch) {
      const IndexRange some{first, std::min(rows.end, first + k_rows_per_launch)};
      check_cuda(cudaMemsetAsync(next(), 0, sizeof(int), stream_), "clearing a counter");
      find_weighted_cells<<<blocks, k_row_threads, 0, stream_>>>(boxes_.tree(), some, next(), lists());
      check_cuda(cudaGetLastError(), "finding cells");
      if (some.end == rows.end) break;
      check_cuda(cudaStreamSynchronize(stream_), "finding cells");
      report(k_rows * (some.end - rows.begin) / rows.count());
    }
    const int far_blocks = blocks_of(reinterpret_cast<const void*>(find_far_weighted_cells), k_far_threads, 0, device);
    find_others([&](const FarCells& far, const DeviceLists& to) {
      find_far_weighted_cells<<<far_blocks, k_far_threads, 0, stream_>>>(boxes_.tree(), far, to);
    });
  }
  /// See CellFinder.
  template <class Report, class Meanwhile, class Undo>
  void start(int device, Report&& report, Meanwhile&& meanwhile, Undo&&) {
    start(device, report);
    meanwhile();
  }

 private:
  static constexpr double k_rows = 0.9;  ///< of all time, until they are done
  const WeightedBoxes boxes_;
  std::size_t member_;
  std::vector<std::int32_t> begins_;
};

}  // namespace
}  // namespace saddleback::voronoi2d
