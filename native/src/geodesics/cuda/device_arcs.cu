// Finding a graph's arcs on a CUDA device. A warp takes a source or two at a time, with all their windows in shared
// memory; sources that overflow it are done again with more room, and what overflows even that is left to the caller.
// The answer is the processor's, to the bit.

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "geodesics/cuda/device_arcs.h"
#include "geodesics/cuda/device_boundary.cuh"
#include "geodesics/cuda/device_mesh_tables.cuh"
#include "geodesics/cuda/device_row_writer.cuh"
#include "geodesics/cuda/device_union.cuh"
#include "geodesics/cuda/device_windows.cuh"
#include "support/cuda/device_stream.h"
#include "support/cuda/device_team.h"
#include "support/cuda/host_copies.h"

namespace saddleback {
namespace {

// Sources of a launch at most: systems that draw with a device let nothing run on it for more than seconds.
constexpr std::int32_t k_sources_per_launch = 1 << 20;

/// Most memory that the warps of a block share on any device; what a device with less has room for is found at run
/// time.
constexpr std::size_t k_shared_bytes = 227 << 10;

/// Room for the windows of a warp's sources and the vertices that they reach; what is not in shared memory is in global
/// memory. What overflows one goes on to the next.
template <bool All_, int Windows, int Slots, int Seats_, bool TableIsShared, bool PoolIsShared>
struct Room {
  static constexpr bool All = All_, table_is_shared = TableIsShared, pool_is_shared = PoolIsShared;
  static constexpr int Seats = Seats_;
  using Table = WaveTable<All, Slots>;
  using Pool = WindowPool<All, Windows, Slots>;
  using Best = BestSightings<Table, Seats>;
  static_assert(sizeof(Best) <= sizeof(Pool));
  static constexpr std::size_t warp_bytes = (TableIsShared ? sizeof(Table) : 0) + (PoolIsShared ? sizeof(Pool) : 0);
  static constexpr int k_most_warps = 24;
  static constexpr int Warps =
      warp_bytes * k_most_warps <= k_shared_bytes ? k_most_warps : static_cast<int>(k_shared_bytes / warp_bytes);
};
/// Chooses by the arcs that are asked for. Fewer windows at once leave room for more sources at once.
template <bool All>
using SmallRoom = Room<All, All ? 80 : 72, All ? 256 : 512, All ? 1 : 2, true, true>;
template <bool All>
using MiddleRoom = Room<All, All ? 140 : 128, All ? 256 : 512, 1, true, true>;
template <bool All>
using WideRoom = Room<All, All ? 256 : 192, 768, 1, true, true>;
template <bool All>
using HugeRoom = Room<All, 512, 2048, 1, true, false>;
/// A thousand sources at a time.
template <bool All>
using LastRoom = Room<All, 8192, 1 << 14, 1, false, false>;
constexpr int k_most_in_last = 1024;

/// Tells whether there are edges that are none for WarpWaves, nodes that the processor gives a unit of their own, or
/// corners that it places in another way.
__global__ void look_for_extremes(DeviceMesh mesh, std::int32_t nodes, int* has_extremes) {
  for (auto node = static_cast<std::int32_t>(blockIdx.x * blockDim.x + threadIdx.x); node < nodes;
       node += static_cast<std::int32_t>(gridDim.x * blockDim.x)) {
    double shortest = k_longest, longest = 0, farthest = 0;
    for (std::int32_t e = mesh.first[node]; e < mesh.first[node + 1]; ++e) {
      const EdgeRecord& record = mesh.records[e];
      shortest = min(shortest, mesh.lengths[e]);
      longest = max(longest, mesh.lengths[e]);
      farthest = max(farthest, record.a * record.a + record.b * record.b);
    }
    const bool is_usual = longest < k_longest && shortest * k_longest > 1 && longest >= k_small_edges;
    if (!(is_usual && farthest < k_extreme * k_extreme / 4)) *has_extremes = 1;
  }
}

struct Work {
  const volatile int* fails;   ///< whether all do
  const std::int32_t* nodes;   ///< null: all from `begin` on
  const std::int32_t* listed;  ///< how many nodes; null: `count`
  std::int32_t begin, count;
  std::int32_t* next;      ///< counts what is taken
  std::int32_t* failed;    ///< nodes
  std::int32_t* failures;  ///< their number
};

/// Global memory of all warps, each of which has one of its places; in one piece.
template <class Room>
struct Scratch {
  using Table = typename Room::Table;
  using Pool = typename Room::Pool;
  using Edges = EdgeDistances<Table::Slots>;
  Table* tables;
  Pool* pools;
  Edges* edges;  ///< where disks end by count
  Sighting* drafts;

  static std::size_t bytes(std::size_t places) { return places * (k_tables + k_pools + k_edges + k_drafts); }
  Scratch(char* memory, std::size_t places)
      : tables(reinterpret_cast<Table*>(memory)),
        pools(reinterpret_cast<Pool*>(memory + places * k_tables)),
        edges(reinterpret_cast<Edges*>(memory + places * (k_tables + k_pools))),
        drafts(reinterpret_cast<Sighting*>(memory + places * (k_tables + k_pools + k_edges))) {}

 private:
  static constexpr std::size_t k_tables = Room::table_is_shared ? 0 : sizeof(Table);
  static constexpr std::size_t k_pools = Room::pool_is_shared ? 0 : sizeof(Pool);
  static constexpr std::size_t k_edges = Table::All ? sizeof(Edges) : 0;
  static constexpr std::size_t k_drafts = sizeof(Sighting) * Table::Draft;
  static_assert((k_tables | k_pools | k_edges | k_drafts) % 16 == 0);
};

/// Warps that have nothing in common but the memory that they divide among themselves.
template <class Room>
__global__ void __launch_bounds__(32 * Room::Warps, 1)
    find_arcs(DeviceMesh mesh, Work work, Scratch<Room> scratch, DeviceRows rows) {
  extern __shared__ __align__(16) char memory[];
  using Table = typename Room::Table;
  using Pool = typename Room::Pool;
  using Waves = WarpWaves<Table, Pool, Room::Seats>;
  const int lane = threadIdx.x & 31, warp = static_cast<int>(threadIdx.x) / 32;
  const std::size_t place = static_cast<std::size_t>(blockIdx.x) * (blockDim.x / 32) + warp;
  char* const own = memory + warp * Room::warp_bytes;
  Table& table = Room::table_is_shared ? *reinterpret_cast<Table*>(own) : scratch.tables[place];
  Pool& pool = Room::pool_is_shared ? *reinterpret_cast<Pool*>(own + sizeof table) : scratch.pools[place];
  Waves waves(mesh, table, pool, scratch.edges + place, scratch.drafts + place * Table::Draft);
  const std::int32_t count = work.listed ? *work.listed : work.count;
  while (true) {
    std::int32_t number = 0;
    if (lane == 0) number = atomicAdd(work.next, Room::Seats);
    number = uniform(number);
    if (number >= count) return;
    const std::int32_t first = work.nodes ? work.nodes[number] : work.begin + number;
    const int taken = min(Room::Seats, count - number);
    // What is too much for several together may do for each.
    for (int seat = 0, together = taken; seat < taken;) {
      const WarpSources sources{first + seat, together};
      bool done = false;
      if (*work.fails == 0) {
        waves.begin(sources);
        done = waves.run();
        auto& best = reinterpret_cast<typename Room::Best&>(pool);
        if (done) done = RowWriter<Waves, Table, Room::Seats>(mesh, waves, best).write(rows);
      }
      __syncwarp();
      if (!done && together > 1) {
        together = 1;
        continue;
      }
      if (!done && lane == 0) work.failed[atomicAdd(work.failures, 1)] = sources.node;
      seat += together;
    }
    __syncwarp();
  }
}

/// Words that memory is taken for at first; more are found to be needed when they are. By accuracy a third more than
/// smooth meshes have at half a percent; arcs become more as the root of what is allowed becomes less. A bound keeps
/// what is next to exact from being refused for memory that it may not need.
std::int64_t first_guess(const ArcsRequest& r, IndexRange nodes) {
  constexpr double k_usual = 96, k_usual_excess = 5.2e-3, k_most = 512;
  const double by_accuracy = std::min(k_most, k_usual * std::sqrt(std::max(1.0, k_usual_excess / r.excess)));
  const std::int64_t per_row = r.k > 0 ? r.k + r.k / 8 + 24 : static_cast<std::int64_t>(by_accuracy);
  return per_row * nodes.count() + 4096;
}

/// Holds shares of all time, at the end of each part.
struct Share {
  static constexpr double upload = 0.15, find = 0.55, unite = 0.6;
};

/// Says which part of the work one of a team's devices has.
struct Part {
  int member, device;
  IndexRange nodes;
};

class ArcFinder {
 public:
  template <class ChoosePacking>
  ArcFinder(const ArcsRequest& request, const Part& part, TeamCaller<ArcsCaller>& caller, cudaStream_t stream,
            cudaStream_t aside, ChoosePacking&& choose_packing)
      : request_(request),
        part_(part),
        caller_(caller),
        stream_(stream),
        aside_(aside),
        failed_{DeviceBuffer<std::int32_t>(static_cast<std::size_t>(part.nodes.count()), stream),
                DeviceBuffer<std::int32_t>(static_cast<std::size_t>(part.nodes.count()), stream)},
        tally_(1, stream),
        fails_(1, stream),
        rows_(request.node_count, first_guess(request, part.nodes), stream),
        scratch_(first_scratch(), stream),
        tables_(request, stream, choose_packing) {
    rows_.set_target_mask(packing().target_mask);
    fails_.fill_bytes(request.is_callers ? 1 : 0);
    look_for_extremes<<<256, 256, 0, stream>>>(tables_.mesh(), request.node_count, fails_.data());
    check_cuda(cudaGetLastError(), "looking at edges");
  }

  /// Lets the device begin; it need not have finished its work before.
  void start() {
    rows_.clear();
    tally_.fill_bytes(0);
    passes_ = 0;
    request_.k > 0 ? start_passes<true>() : start_passes<false>();
  }
  /// Waits until all are found. \return whether there was more to do than what was started
  bool finish(DeviceTimes& times) {
    for (bool more = false;; more = true) {
      more |= request_.k > 0 ? finish_passes<true>(times) : finish_passes<false>(times);
      const std::int64_t wanted = rows_.words_wanted();
      if (wanted <= rows_.room()) return more;
      rows_ = RowStore(request_.node_count, wanted + wanted / 16, stream_);
      rows_.set_target_mask(packing().target_mask);
      start();
    }
  }
  RowStore& rows() { return rows_; }
  /// Returns the rows while they are being found.
  DeviceRows rows_in_making() {
    DeviceRows rows = rows_.view();
    rows.taken = &tally_.data()->words;
    rows.left = tally_.data()->failed + (passes_ - 1);
    return rows;
  }
  const ArcPacking& packing() const { return tables_.mesh().packing; }

 private:
  /// Rooms that a source may go through.
  static constexpr std::size_t k_passes = 4;
  /// Holds what kernels count.
  struct Tally {
    unsigned long long words;  ///< of all rows
    /// Holds them by pass: sources taken, and those that failed.
    std::int32_t begun[k_passes], failed[k_passes];
  };

  /// The second does not wait to know how many are left.
  template <bool All>
  void start_passes() {
    const std::int32_t all = part_.nodes.count();
    if (is_small()) {
      find_in<SmallRoom<All>>(all);
    } else if (is_middle()) {
      find_in<MiddleRoom<All>>(all);
    }
    find_in<WideRoom<All>>(all);
  }
  /// \return whether sources were left
  template <bool All>
  bool finish_passes(DeviceTimes& times) {
    Tally tally = finished();
    const auto left = [&] { return tally.failed[passes_ - 1]; };
    times.second_pass = tally.failed[0];
    times.by_processor = 0;
    const bool any_left = left() > 0;
    if (any_left) {
      find_in<HugeRoom<All>>(left());
      tally = finished();
    }
    if (left() > 0) {
      find_in<LastRoom<All>>(left());
      tally = finished();
    }
    rows_.note_wanted(static_cast<std::int64_t>(tally.words));
    if (left() > 0) find_rest(left(), failed_[(passes_ - 1) % 2], times);
    return any_left;
  }

  /// Finds the rest by the processor. What ends the windows of one node there may be those of others of its batch: all
  /// have to be done.
  void find_rest(std::int32_t count, const DeviceBuffer<std::int32_t>& nodes, DeviceTimes& times) {
    std::vector<std::int32_t> failed(static_cast<std::size_t>(count)), left;
    nodes.read(failed);
    times.by_processor = count;
    std::ranges::sort(failed);  // they failed in any order
    for (const std::int32_t node : failed) {
      const std::int32_t first = node / k_batch * k_batch;
      if (!left.empty() && first <= left.back()) continue;
      for (std::int32_t n = first; n < std::min(first + k_batch, part_.nodes.end); ++n) left.push_back(n);
    }
    caller_.ask([&](const ArcsCaller& caller) {
      FoundRows found{};
      if (!caller.find_rows(caller.self, left.data(), static_cast<std::int32_t>(left.size()), &found)) return false;
      rows_.append(left, found);
      return true;
    });
  }

  bool is_small() const { return request_.k > 0 ? request_.k <= 50 : request_.excess >= 3e-3; }
  bool is_middle() const { return request_.k <= 110; }

  /// Holds how the warps of a pass are spread over the device.
  struct Spread {
    int blocks, warps;
    std::size_t shared;  ///< bytes of a block
    std::size_t places() const { return static_cast<std::size_t>(blocks) * warps; }
  };
  /// Sets the kernel up for it as well.
  template <class Room>
  Spread spread_of(std::int32_t most) const {
    const auto kernel = find_arcs<Room>;
    const void* const code = reinterpret_cast<const void*>(kernel);
    const int most_warps = warps_of_block(Room::warp_bytes, Room::Warps);
    // The attribute is the kernel's: what a member of the team sets holds for others who share its device.
    check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                    static_cast<int>(most_warps * Room::warp_bytes)),
               "asking for shared memory");
    const int warps = std::min(most_warps, most / Room::Seats / processors() + 1);
    const std::size_t shared = warps * Room::warp_bytes;
    // Pools that are not in shared memory had better be in the cache beside it.
    constexpr int k_carveout = Room::pool_is_shared ? 100 : 75;
    check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributePreferredSharedMemoryCarveout, k_carveout),
               "asking for shared memory");
    int blocks = std::min(blocks_of(code, 32 * warps, shared), (most / Room::Seats + warps) / warps);
    if (!Room::table_is_shared) blocks = std::min(blocks, k_most_in_last / warps);
    return {blocks, warps, shared};
  }

  /// Bytes that the passes take which are started at first.
  std::size_t first_scratch() const { return request_.k > 0 ? first_scratch_of<true>() : first_scratch_of<false>(); }
  template <bool All>
  std::size_t first_scratch_of() const {
    const std::int32_t all = part_.nodes.count();
    const std::size_t wide = Scratch<WideRoom<All>>::bytes(spread_of<WideRoom<All>>(all).places());
    if (is_small()) return std::max(wide, Scratch<SmallRoom<All>>::bytes(spread_of<SmallRoom<All>>(all).places()));
    if (is_middle()) return std::max(wide, Scratch<MiddleRoom<All>>::bytes(spread_of<MiddleRoom<All>>(all).places()));
    return wide;
  }

  /// A pass. Of all nodes or, from the second on, those that failed in the one before: `most` at most, so that no more
  /// warps get memory than find work, and few are spread over all processors.
  template <class Room>
  void find_in(std::int32_t most) {
    const std::size_t pass = passes_++;
    const Spread spread = spread_of<Room>(most);
    const std::size_t bytes = Scratch<Room>::bytes(spread.places());
    if (scratch_.size() < bytes) scratch_ = DeviceBuffer<char>(bytes, stream_);
    const Scratch<Room> scratch(scratch_.data(), spread.places());
    const std::int32_t all = part_.nodes.count();
    const std::int32_t launches = (all - 1) / k_sources_per_launch + 1;
    const std::int32_t at_once = (all / launches / Room::Seats + 1) * Room::Seats;
    Tally* const tally = tally_.data();
    const DeviceRows rows = rows_in_making();
    for (std::int32_t begin = 0; begin < all; begin += at_once) {
      if (begin > 0)
        check_cuda(cudaMemsetAsync(tally->begun, 0, sizeof tally->begun, stream_), "starting at the first source");
      if (pass == 0) begun_before_ = begin;
      Work work{fails_.data(),
                nullptr,
                nullptr,
                part_.nodes.begin + begin,
                std::min(at_once, all - begin),
                tally->begun + pass,
                failed_[pass % 2].data(),
                tally->failed + pass};
      if (pass > 0) {
        work.nodes = failed_[1 - pass % 2].data();
        work.listed = tally->failed + pass - 1;
      }
      find_arcs<Room>
          <<<spread.blocks, 32 * spread.warps, spread.shared, stream_>>>(tables_.mesh(), work, scratch, rows);
      check_cuda(cudaGetLastError(), "finding arcs");
      pass_ended_.record(stream_);
      if (pass > 0) break;
      if (launches > 1) wait();
    }
  }

  /// Waits for the passes that were started; a cancel does not wait for sources that take long.
  void wait() {
    try {
      wait_polling(pass_ended_, [&] { report(done_ = std::max(done_, share_begun())); });
    } catch (...) {
      (void)cudaMemsetAsync(fails_.data(), 1, sizeof(int), aside_);
      (void)cudaStreamSynchronize(stream_);
      throw;
    }
  }

  /// Returns the share of all sources. Those that fail in a pass count for a tenth of what was left before it.
  double share_begun() const {
    Tally tally = tally_.value_at(0, aside_);
    tally.begun[0] += begun_before_;
    double left = 1;
    for (std::size_t pass = 0; pass < passes_; ++pass) {
      const std::int32_t all = pass == 0 ? part_.nodes.count() : tally.failed[pass - 1];
      const double share = tally.begun[pass] < all ? static_cast<double>(tally.begun[pass]) / all : 1;
      left -= 0.9 * left * share;
      if (share < 1) break;
    }
    return 1 - left;
  }

  /// Warps for which a block has the memory.
  int warps_of_block(std::size_t warp_bytes, int most) const {
    int bytes = 0;
    check_cuda(cudaDeviceGetAttribute(&bytes, cudaDevAttrMaxSharedMemoryPerBlockOptin, part_.device),
               "asking for the size of shared memory");
    if (warp_bytes == 0) return most;
    const int warps = std::min(most, static_cast<int>(static_cast<std::size_t>(bytes) / warp_bytes));
    if (warps == 0) throw std::runtime_error("the device has too little shared memory for the graph");
    return warps;
  }

  int processors() const {
    int count = 0;
    check_cuda(cudaDeviceGetAttribute(&count, cudaDevAttrMultiProcessorCount, part_.device),
               "asking for the number of processors");
    return count;
  }
  int blocks_of(const void* kernel, int threads, std::size_t shared) const {
    int per_processor = 0;
    check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&per_processor, kernel, threads, shared),
               "asking for occupancy");
    return std::max(1, per_processor) * processors();
  }

  /// Returns what was counted once all that was started is done.
  Tally finished() {
    wait();
    return tally_.value_at(0, aside_);
  }

  void report(double fraction) const {
    caller_.report(part_.member, Share::upload + (Share::find - Share::upload) * fraction);
  }

  const ArcsRequest& request_;
  Part part_;
  TeamCaller<ArcsCaller>& caller_;
  cudaStream_t stream_, aside_;           ///< that of the work, and one in which to look how far it is
  StreamEvent pass_ended_;                ///< the last that was started
  DeviceBuffer<std::int32_t> failed_[2];  ///< nodes that failed in passes of even and of odd number
  DeviceBuffer<Tally> tally_;
  DeviceBuffer<int> fails_;  ///< whether all sources do: there are extremes, or the caller asked to stop
  RowStore rows_;
  DeviceBuffer<char> scratch_;     ///< of the pass that is running
  MeshTables tables_;              ///< made last: the device would have to wait while memory is taken after that
  std::size_t passes_ = 0;         ///< that were started
  std::int32_t begun_before_ = 0;  ///< sources, by launches of the first pass before the last
  double done_ = 0;                ///< share of the sources, as far as is known
};

/// Returns what a build takes at most of a device that has these nodes, in bytes.
std::uint64_t bytes_needed(const ArcsRequest& r, IndexRange range, std::size_t others) {
  const auto words = static_cast<std::uint64_t>(first_guess(r, range));
  constexpr std::uint64_t k_row_word = 8 + 4 + 1 + 4;  // see DeviceRows
  constexpr std::uint64_t k_union_word = (sizeof(AddedArc) + 8) / 4 + 1 + 8, k_drafts = std::uint64_t{160} << 20;
  const std::uint64_t across = others * (static_cast<std::uint64_t>(range.count()) * sizeof(RowAcross) +
                                         words / ArcsForOthers::k_of_as_many * sizeof(ArcAcross));
  return MeshTables::bytes_needed(r) + static_cast<std::uint64_t>(r.node_count) * 48 +
         words * (k_row_word + k_union_word) + 2 * across + k_drafts;  // its own, and theirs
}

/// A graph found by one or several devices, each the rows of a range of nodes.
class Builder {
 public:
  Builder(const ArcsRequest& request, const ArcsCaller& caller)
      : request_(request),
        team_({request.devices, static_cast<std::size_t>(std::min(request.device_count, request.node_count))}),
        caller_(caller, team_),
        streams_(members()),
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
      const auto begin = static_cast<std::int32_t>(request_.node_count * i / team_.members());
      return i == team_.members() ? begin : begin / k_batch * k_batch;  // no batch is divided
    };
    return {member, team_.device(member), {begin_of(member), begin_of(member + 1)}};
  }

  void build_part(const Part& mine) {
    check_cuda(cudaSetDevice(mine.device), "choosing the device");
    check_device_room("the graph", bytes_needed(request_, mine.nodes, members() - 1), request_.most_bytes);
    keep_freed_memory(mine.device);
    const auto at = static_cast<std::size_t>(mine.member);
    DeviceTimes& times = times_[at];
    const Stream& stream = streams_[at].emplace();
    const Stream aside;
    Stopwatch watch(stream);
    DeviceUnion arcs(request_.node_count, mine.nodes, first_guess(request_, mine.nodes), stream);
    ArcFinder finder(request_, mine, caller_, stream, aside, [&] { return packing(mine.member); });
    watch.end();
    // The device gets its next work while it still does the last.
    finder.start();
    times.upload = watch.read();
    watch.end();
    Stopwatch uniting(stream);
    const bool is_alone = team_.members() == 1;
    ArcsForOthers& across =
        across_[at].emplace(mine.nodes, ranges_of_others(mine.member), finder.rows().room(), stream);
    if (is_alone) arcs.unite(finder.packing(), finder.rows_in_making());
    uniting.end();
    HostCopies copies(stream);
    if (mine.member == 0) expect_words(copies);
    const bool found_more = finder.finish(times);
    if (found_more) watch.end();
    times.find = watch.read();
    if (found_more || !is_alone) {
      team_.meet();  // or who is done first would take the others' time for its own
      uniting.start();
      across.choose(finder.rows().view());
      team_.meet();
      add_rows(finder.rows(), mine.device, arcs_there(mine.member), stream);
      arcs.unite(finder.packing(), finder.rows().view());
      uniting.end();
    }
    if (!arcs.fits(aside)) {
      arcs.make_room();
      arcs.unite(finder.packing(), finder.rows().view());
      uniting.end();
    }
    caller_.report(mine.member, Share::unite);
    counts_[at] = arcs.count();
    team_.meet();
    if (mine.member == 0) {
      copies.end_populating();
      make_room(std::accumulate(counts_.begin(), counts_.end(), std::int64_t{0}));
    }
    team_.meet();
    arcs.copy(copies, std::accumulate(counts_.begin(), counts_.begin() + mine.member, std::int64_t{0}), offsets_,
              words_);
    copies.finish([&](double share) { caller_.report(mine.member, Share::unite + (1 - Share::unite) * share); });
    times.unite = uniting.read();
    times.download = uniting.lap();  // as far as it took longer
    across_[at].reset();             // all have united
  }

  void make_room(std::int64_t words) {
    caller_.ask([&](const ArcsCaller& c) { return c.make_room(c.self, words, &offsets_, &words_); });
  }
  /// Has room made, and pages laid, while arcs are found: both take milliseconds. Room for what smooth meshes have, and
  /// pages for what nearly all have: neither is given back.
  void expect_words(HostCopies& copies) {
    const std::int64_t guess = first_guess(request_, {0, request_.node_count});
    const bool by_count = request_.k > 0;  // then it is known better
    make_room(by_count ? guess : guess / 5 * 4);
    const std::int64_t usual = by_count ? std::int64_t{request_.k} * request_.node_count : guess / 8 * 5;
    copies.expect(words_, static_cast<std::size_t>(usual) * sizeof *words_);
  }

  /// The first asks for all.
  const ArcPacking& packing(int member) {
    if (member == 0)
      caller_.ask([&](const ArcsCaller& caller) { return caller.choose_packing(caller.self, &packing_); });
    team_.meet();
    return packing_;
  }

  std::vector<IndexRange> ranges_of_others(int member) const {
    std::vector<IndexRange> ranges;
    for (int other = 0; other < team_.members(); ++other)
      if (other != member) ranges.push_back(part(other).nodes);
    return ranges;
  }
  /// Returns what the others have chosen for a member.
  std::vector<ArcsThere> arcs_there(int member) const {
    std::vector<ArcsThere> there;
    for (int other = 0; other < team_.members(); ++other) {
      if (other == member) continue;
      const ArcsForOthers& across = *across_[static_cast<std::size_t>(other)];
      const auto number = static_cast<std::size_t>(member < other ? member : member - 1);  // it is none of its others
      there.push_back({team_.device(other), across.nodes(), across.rows(number), across.arcs(number)});
    }
    return there;
  }

  const ArcsRequest& request_;
  DeviceTeam team_;
  TeamCaller<ArcsCaller> caller_;
  std::vector<std::optional<Stream>> streams_;        ///< by member; across_ is freed in them when a member fails
  std::vector<std::optional<ArcsForOthers>> across_;  ///< by member
  std::vector<std::int64_t> counts_;                  ///< words, by member
  std::vector<DeviceTimes> times_;
  ArcPacking packing_;
  std::int64_t* offsets_ = nullptr;
  std::uint64_t* words_ = nullptr;
};

}  // namespace

CudaStatus find_arcs_on_device(const ArcsRequest& request, const ArcsCaller& caller, DeviceTimes& times,
                               CudaReason& reason) {
  return cuda_status(reason, [&] { times = Builder(request, caller).build(); });
}

}  // namespace saddleback
