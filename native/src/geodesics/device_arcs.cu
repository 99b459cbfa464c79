// Finding a graph's arcs on a CUDA device. A warp takes a source at a time, with all its windows in shared
// memory; sources that overflow it are done again with room in global memory, and what overflows even that is left to
// the caller. The answer is the processor's, to the bit.

#include <algorithm>
#include <numeric>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "geodesics/device_arcs.h"
#include "geodesics/device_boundary.cuh"
#include "geodesics/device_union.cuh"
#include "geodesics/device_waves.cuh"
#include "support/device_stream.h"
#include "support/device_team.h"
#include "support/host_copies.h"

namespace saddleback {
namespace {

constexpr int k_draft_room = 2048;
constexpr int k_large_draft_room = 1 << 15;
// Sources between two looks at whether to go on: a few milliseconds.
constexpr std::int32_t k_sources_per_launch = 1 << 18;

/// Room for the windows of a source and the vertices that it reaches. What overflows one goes on to the next.
template <bool All_, int Ring, int Slots, bool RingsAreShared>
struct Room {
  static constexpr bool All = All_;
  [[maybe_unused]] static constexpr bool rings_are_shared = RingsAreShared;
  using Table = WaveTable<All, Slots>;
  using Rings = WaveRings<All, Ring>;
  [[maybe_unused]] static constexpr std::size_t shared_bytes = sizeof(Table) + (RingsAreShared ? sizeof(Rings) : 0);
};
template <bool All>
using SmallRoom = Room<All, 48, 256, true>;
template <bool All>
using MiddleRoom = Room<All, All ? 160 : 112, 512, false>;
template <bool All>
using WideRoom = Room<All, 512, 2048, false>;
/// In global memory, two thousand sources at a time.
template <bool All>
using LargeRoom = Room<All, 4096, 1 << 14, false>;

/// Whether there are edges that are none for WarpWaves.
__global__ void look_for_extremes(const double* lengths, std::int32_t count, int* has_extremes) {
  for (auto i = static_cast<std::int32_t>(blockIdx.x * blockDim.x + threadIdx.x); i < count;
       i += static_cast<std::int32_t>(gridDim.x * blockDim.x))
    if (!(lengths[i] < k_longest && lengths[i] * k_longest > 1)) *has_extremes = 1;
}

/// Sees to it that who looks a record up need not look up its apex as well.
__global__ void note_saddles(EdgeRecord* records, std::int32_t count, const std::uint8_t* saddles) {
  for (auto i = static_cast<std::int32_t>(blockIdx.x * blockDim.x + threadIdx.x); i < count;
       i += static_cast<std::int32_t>(gridDim.x * blockDim.x))
    if (saddles[records[i].apex] != 0) records[i].clearances |= k_saddle_bit;
}

struct Work {
  const int* fails;           ///< whether all do
  const std::int32_t* nodes;  ///< null: all from `begin` on
  std::int32_t begin, count;
  std::int32_t* next;      ///< counts what is taken
  std::int32_t* failed;    ///< nodes
  std::int32_t* failures;  ///< their number
};

template <class Room>
__device__ void work_through(const DeviceMesh& mesh, const Work& work, typename Room::Table& table,
                             typename Room::Rings& rings, Sighting* draft, int draft_room, const DeviceRows& rows) {
  const int lane = threadIdx.x & 31;
  WarpWaves<Room::All, typename Room::Table, typename Room::Rings> waves(mesh, table, rings, draft, draft_room);
  while (true) {
    std::int32_t number = 0;
    if (lane == 0) number = atomicAdd(work.next, 1);
    number = __shfl_sync(k_warp, number, 0);
    if (number >= work.count) return;
    const std::int32_t node = work.nodes ? work.nodes[number] : work.begin + number;
    waves.begin(node);
    if (*work.fails == 0 && waves.run()) {
      int count = 0;
      waves.for_each_kept([&](const Sighting&, unsigned kept) { count += __popc(kept); });
      const RowPlace row = rows.reserve(node, count);
      std::int64_t at = row.first;
      waves.for_each_kept([&](const Sighting& seen, unsigned kept) {
        if (row.fits && (kept >> lane & 1)) {
          const auto [word, back_sector] = waves.arc_of(seen);
          rows.put(at + __popc(kept & ((1u << lane) - 1)), word, back_sector);
        }
        at += __popc(kept);
      });
    } else if (lane == 0) {
      work.failed[atomicAdd(work.failures, 1)] = node;
    }
    __syncwarp();
  }
}

/// One warp a block. The table is in shared memory, and the rings where they are small.
template <class Room>
__global__ void __launch_bounds__(32)
    find_arcs(DeviceMesh mesh, Work work, typename Room::Rings* rings, Sighting* drafts, DeviceRows rows) {
  extern __shared__ __align__(16) char memory[];
  auto& table = *reinterpret_cast<typename Room::Table*>(memory);
  Sighting* const draft = drafts + static_cast<std::size_t>(blockIdx.x) * k_draft_room;
  if constexpr (Room::rings_are_shared) {
    auto& own = *reinterpret_cast<typename Room::Rings*>(memory + sizeof table);
    work_through<Room>(mesh, work, table, own, draft, k_draft_room, rows);
  } else {
    work_through<Room>(mesh, work, table, rings[blockIdx.x], draft, k_draft_room, rows);
  }
}

/// One warp a block, in global memory.
template <class Room>
__global__ void __launch_bounds__(32) find_large_disks(DeviceMesh mesh, Work work, typename Room::Table* tables,
                                                       typename Room::Rings* rings, Sighting* drafts, DeviceRows rows) {
  work_through<Room>(mesh, work, tables[blockIdx.x], rings[blockIdx.x],
                     drafts + static_cast<std::size_t>(blockIdx.x) * k_large_draft_room, k_large_draft_room, rows);
}

/// Host memory of the request, on the device.
class Tables {
 public:
  Tables(const ArcTwinRequest& r, cudaStream_t stream)
      : records_(edges(r), stream),
        first_(nodes(r) + 1, stream),
        targets_(edges(r), stream),
        lengths_(edges(r), stream),
        sectors_(edges(r), stream),
        reverse_sectors_(edges(r), stream),
        apex_sectors_(edges(r), stream),
        per_radian_(nodes(r), stream),
        saddles_(nodes(r), stream),
        mesh_{records_.data(),
              first_.data(),
              targets_.data(),
              lengths_.data(),
              sectors_.data(),
              reverse_sectors_.data(),
              apex_sectors_.data(),
              per_radian_.data(),
              saddles_.data(),
              r.unit,
              r.packing,
              r.k,
              r.detour,
              r.excess,
              r.slack} {
    HostCopies copies(stream);
    const auto fill = [&](const auto* from, auto& to) { copies.to_device(from, to.size(), to.data()); };
    fill(r.records, records_);
    fill(r.first, first_);
    fill(r.targets, targets_);
    fill(r.lengths, lengths_);
    fill(r.sectors, sectors_);
    fill(r.reverse_sectors, reverse_sectors_);
    fill(r.apex_sectors, apex_sectors_);
    fill(r.per_radian, per_radian_);
    fill(r.saddles, saddles_);
    copies.finish();
    note_saddles<<<256, 256, 0, stream>>>(records_.data(), r.edge_count, saddles_.data());
    check_cuda(cudaGetLastError(), "noting saddles");
  }
  const DeviceMesh& mesh() const { return mesh_; }

 private:
  static std::size_t edges(const ArcTwinRequest& r) { return static_cast<std::size_t>(r.edge_count); }
  static std::size_t nodes(const ArcTwinRequest& r) { return static_cast<std::size_t>(r.node_count); }
  DeviceBuffer<EdgeRecord> records_;
  DeviceBuffer<std::int32_t> first_, targets_;
  DeviceBuffer<double> lengths_;
  DeviceBuffer<float> sectors_, reverse_sectors_, apex_sectors_, per_radian_;
  DeviceBuffer<std::uint8_t> saddles_;
  DeviceMesh mesh_;
};

/// Words that memory is taken for at first; more are found to be needed when they are.
std::int64_t first_guess(const ArcTwinRequest& r, IndexRange nodes) {
  const std::int64_t per_row = r.k > 0 ? r.k + r.k / 8 + 24 : 96;
  return per_row * nodes.count() + 4096;
}

/// Of all time, at the end of each part.
struct Share {
  static constexpr double upload = 0.15, find = 0.55, unite = 0.6;
};

/// Which part of the work one of a team's devices has.
struct Part {
  int member, device;
  IndexRange nodes;
};

class ArcFinder {
 public:
  ArcFinder(const ArcTwinRequest& request, const Part& part, TeamCaller<ArcTwinCaller>& caller, cudaStream_t stream)
      : request_(request),
        part_(part),
        caller_(caller),
        stream_(stream),
        tables_(request, stream),
        failed_(static_cast<std::size_t>(part.nodes.count()), stream),
        counters_(2, stream),
        has_extremes_(1, stream),
        rows_(request.node_count, first_guess(request, part.nodes), request.packing.target_mask, stream) {
    has_extremes_.fill_bytes(0);
    look_for_extremes<<<256, 256, 0, stream>>>(tables_.mesh().lengths, request.edge_count, has_extremes_.data());
    check_cuda(cudaGetLastError(), "looking at edges");
  }

  void find(DeviceTimes& times) {
    while (true) {
      find_all(times);
      const std::int64_t wanted = rows_.words_wanted();
      if (wanted <= rows_.room()) return;
      rows_ = RowStore(request_.node_count, wanted + wanted / 16, request_.packing.target_mask, stream_);
    }
  }
  RowStore& rows() { return rows_; }

 private:
  void find_all(DeviceTimes& times) {
    rows_.clear();
    times.second_pass = times.by_processor = 0;
    if (request_.k > 0) {
      find_by_size<true>(request_.k <= 40, times);
    } else {
      find_by_size<false>(request_.excess >= 6e-3, times);
    }
  }

  /// `small` when most sources need little memory: then more of them run at once.
  template <bool All>
  void find_by_size(bool small, DeviceTimes& times) {
    std::vector<std::int32_t> left;
    bool all = true;
    const auto pass = [&]<class Room>(std::type_identity<Room>) {
      left = find_in_shared<Room>(all ? nullptr : &left);
      all = false;
    };
    if (small) pass(std::type_identity<SmallRoom<All>>());
    if (all || !left.empty()) pass(std::type_identity<MiddleRoom<All>>());
    times.second_pass = static_cast<std::int64_t>(left.size());
    if (!left.empty()) pass(std::type_identity<WideRoom<All>>());
    if (!left.empty()) find_large<All>(left, times);
  }

  /// Of all nodes or those listed. \return what did not find room.
  template <class Room>
  std::vector<std::int32_t> find_in_shared(const std::vector<std::int32_t>* nodes) {
    const auto kernel = find_arcs<Room>;
    check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, Room::shared_bytes),
               "asking for shared memory");
    // Rings that are not in shared memory had better be in the cache beside it.
    constexpr int k_carveout = Room::rings_are_shared ? 100 : 75;
    check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributePreferredSharedMemoryCarveout, k_carveout),
               "asking for shared memory");
    const int blocks = blocks_of(reinterpret_cast<const void*>(kernel), Room::shared_bytes);
    DeviceBuffer<Sighting> drafts(static_cast<std::size_t>(blocks) * k_draft_room, stream_);
    DeviceBuffer<typename Room::Rings> rings(Room::rings_are_shared ? 0 : static_cast<std::size_t>(blocks), stream_);
    const std::int32_t all = nodes ? static_cast<std::int32_t>(nodes->size()) : part_.nodes.count();
    const DeviceBuffer<std::int32_t> list(
        nodes ? std::span<const std::int32_t>(*nodes) : std::span<const std::int32_t>(), stream_);
    counters_.fill_bytes(0);
    for (std::int32_t begin = 0; begin < all; begin += k_sources_per_launch) {
      report(nodes ? 0.99 : static_cast<double>(begin) / all);
      const std::int32_t count = std::min(k_sources_per_launch, all - begin);
      check_cuda(cudaMemsetAsync(counters_.data(), 0, sizeof(std::int32_t), stream_), "clearing a counter");
      const Work part = work(nodes ? list.data() + begin : nullptr, part_.nodes.begin + begin, count, failed_);
      kernel<<<std::min(blocks, count), 32, Room::shared_bytes, stream_>>>(tables_.mesh(), part, rings.data(),
                                                                           drafts.data(), rows_.view());
      check_cuda(cudaGetLastError(), "finding arcs");
      if (all > k_sources_per_launch) check_cuda(cudaStreamSynchronize(stream_), "finding arcs");
    }
    return failures(failed_);
  }

  template <bool All>
  void find_large(const std::vector<std::int32_t>& nodes, DeviceTimes& times) {
    using Room = LargeRoom<All>;
    const auto kernel = find_large_disks<Room>;
    const int most = blocks_of(reinterpret_cast<const void*>(kernel), 0);
    const int blocks = std::min({most, static_cast<int>(nodes.size()), 2048});
    DeviceBuffer<Sighting> drafts(static_cast<std::size_t>(blocks) * k_large_draft_room, stream_);
    DeviceBuffer<typename Room::Table> tables(static_cast<std::size_t>(blocks), stream_);
    DeviceBuffer<typename Room::Rings> rings(static_cast<std::size_t>(blocks), stream_);
    const DeviceBuffer<std::int32_t> list(nodes, stream_);
    DeviceBuffer<std::int32_t> failed(nodes.size(), stream_);
    counters_.fill_bytes(0);
    kernel<<<blocks, 32, 0, stream_>>>(tables_.mesh(),
                                       work(list.data(), 0, static_cast<std::int32_t>(nodes.size()), failed),
                                       tables.data(), rings.data(), drafts.data(), rows_.view());
    check_cuda(cudaGetLastError(), "finding arcs of large disks");
    std::vector<std::int32_t> left = failures(failed);
    times.by_processor = static_cast<std::int64_t>(left.size());
    if (left.empty()) return;
    std::ranges::sort(left);
    caller_.ask([&](const ArcTwinCaller& caller) {
      FoundRows found{};
      if (!caller.find_rows(caller.self, left.data(), static_cast<std::int32_t>(left.size()), &found)) return false;
      rows_.append(left, found);
      return true;
    });
  }

  int blocks_of(const void* kernel, std::size_t shared) const {
    int per_processor = 0, processors = 0;
    check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&per_processor, kernel, 32, shared),
               "asking for occupancy");
    check_cuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, part_.device),
               "asking for the number of processors");
    return std::max(1, per_processor) * processors;
  }

  Work work(const std::int32_t* nodes, std::int32_t begin, std::int32_t count, DeviceBuffer<std::int32_t>& failed) {
    return {has_extremes_.data(), nodes, begin, count, counters_.data(), failed.data(), counters_.data() + 1};
  }

  std::vector<std::int32_t> failures(const DeviceBuffer<std::int32_t>& failed) {
    std::int32_t counts[2];
    counters_.read(counts);
    std::vector<std::int32_t> nodes(static_cast<std::size_t>(counts[1]));
    if (!nodes.empty()) {
      check_cuda(cudaMemcpyAsync(nodes.data(), failed.data(), nodes.size() * sizeof(std::int32_t),
                                 cudaMemcpyDeviceToHost, stream_),
                 "copying from the device");
      check_cuda(cudaStreamSynchronize(stream_), "waiting for the device");
      std::ranges::sort(nodes);  // they failed in any order
    }
    return nodes;
  }

  void report(double fraction) const {
    caller_.report(part_.member, Share::upload + (Share::find - Share::upload) * fraction);
  }

  const ArcTwinRequest& request_;
  Part part_;
  TeamCaller<ArcTwinCaller>& caller_;
  cudaStream_t stream_;
  Tables tables_;
  DeviceBuffer<std::int32_t> failed_, counters_, has_extremes_;
  RowStore rows_;
};

/// What a build takes at most of a device that has these nodes, in bytes; rows once more for the union.
std::uint64_t bytes_needed(const ArcTwinRequest& r, IndexRange range) {
  const auto edges = static_cast<std::uint64_t>(r.edge_count), nodes = static_cast<std::uint64_t>(r.node_count);
  const auto words = static_cast<std::uint64_t>(first_guess(r, range));
  constexpr std::uint64_t k_drafts = std::uint64_t{96} << 20;
  return edges * (sizeof(EdgeRecord) + 24) + nodes * 48 + words * (13 + 10) + k_drafts;
}

/// A graph found by one or several devices, each the rows of a range of nodes.
class Builder {
 public:
  Builder(const ArcTwinRequest& request, const ArcTwinCaller& caller)
      : request_(request),
        team_({request.devices, static_cast<std::size_t>(std::min(request.device_count, request.node_count))}),
        caller_(caller, team_),
        across_(members()),
        counts_(members()),
        times_(members()) {}

  DeviceTimes build() {
    team_.run([&](int member) { build_part(part(member)); });
    return slowest(times_);
  }

 private:
  std::size_t members() const { return static_cast<std::size_t>(team_.members()); }
  Part part(int member) const {
    const auto begin_of = [&](std::int64_t i) {
      return static_cast<std::int32_t>(request_.node_count * i / team_.members());
    };
    return {member, team_.device(member), {begin_of(member), begin_of(member + 1)}};
  }

  void build_part(const Part& mine) {
    check_cuda(cudaSetDevice(mine.device), "choosing the device");
    check_device_room("the graph", bytes_needed(request_, mine.nodes), request_.most_bytes);
    keep_freed_memory(mine.device);
    const auto at = static_cast<std::size_t>(mine.member);
    DeviceTimes& times = times_[at];
    const Stream stream;
    Stopwatch watch(stream);
    ArcFinder finder(request_, mine, caller_, stream);
    times.upload = watch.lap();
    finder.find(times);
    times.find = watch.lap();
    exchange(mine, finder.rows(), stream);
    DeviceUnion arcs(request_.packing, finder.rows(), mine.nodes, stream);
    times.unite = watch.lap();
    caller_.report(mine.member, Share::unite);
    counts_[at] = arcs.count();
    team_.meet();
    if (mine.member == 0) {
      const std::int64_t all = std::accumulate(counts_.begin(), counts_.end(), std::int64_t{0});
      caller_.ask([&](const ArcTwinCaller& c) { return c.make_room(c.self, all, &offsets_, &words_); });
    }
    team_.meet();
    watch.lap();
    HostCopies copies(stream);
    arcs.copy(copies, std::accumulate(counts_.begin(), counts_.begin() + mine.member, std::int64_t{0}), offsets_,
              words_);
    copies.finish([&](double share) { caller_.report(mine.member, Share::unite + (1 - Share::unite) * share); });
    times.download = watch.lap();
  }

  /// Gets from the others what pairing needs of their rows.
  void exchange(const Part& mine, RowStore& rows, cudaStream_t stream) {
    if (team_.members() == 1) return;
    std::vector<std::optional<RowStore>>& chosen = across_[static_cast<std::size_t>(mine.member)];
    chosen.resize(members());
    for (int other = 0; other < team_.members(); ++other)
      if (other != mine.member)
        chosen[static_cast<std::size_t>(other)] = rows_across(rows, mine.nodes, part(other).nodes, stream);
    team_.meet();
    std::vector<RowsThere> there;
    for (int other = 0; other < team_.members(); ++other) {
      if (other == mine.member) continue;
      const Part theirs = part(other);
      there.push_back({theirs.device, theirs.nodes,
                       &*across_[static_cast<std::size_t>(other)][static_cast<std::size_t>(mine.member)]});
    }
    add_rows(rows, mine.device, there, stream);
    team_.meet();
    chosen.clear();
  }

  const ArcTwinRequest& request_;
  DeviceTeam team_;
  TeamCaller<ArcTwinCaller> caller_;
  std::vector<std::vector<std::optional<RowStore>>> across_;  ///< by member and by whom they are chosen for
  std::vector<std::int64_t> counts_;                          ///< words, by member
  std::vector<DeviceTimes> times_;
  std::int64_t* offsets_ = nullptr;
  std::uint64_t* words_ = nullptr;
};

}  // namespace

TwinStatus find_arcs_on_device(const ArcTwinRequest& request, const ArcTwinCaller& caller, DeviceTimes& times,
                               TwinReason& reason) {
  return twin_status(reason, [&] { times = Builder(request, caller).build(); });
}

}  // namespace saddleback
