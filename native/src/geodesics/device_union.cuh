#pragma once
// Rows of arcs on the device as they are found, and their union with their reverses: the twin of arc_symmetry.

#include <vector>

#include "geodesics/arc_twin.h"
#include "geodesics/device_sighting_order.cuh"
#include "support/device_buffer.h"
#include "support/device_scratch.cuh"
#include "support/host_copies.h"
#include "support/index_range.cuh"
#include "support/warp.cuh"

namespace saddleback {
namespace {

constexpr int k_block_threads = 256;
constexpr int k_rows_per_block = k_block_threads / 32;

struct RowPlace {
  std::int64_t first;
  bool fits;
};

/// Rows in the order in which they were found: each is in one piece.
struct DeviceRows {
  std::int64_t* firsts;  ///< per node
  std::int32_t* counts;  ///< per node
  std::uint64_t* words;
  std::int32_t* targets;  ///< of the words, to search in
  std::uint8_t* back_sectors;
  std::uint64_t* order;  ///< in the generation, of the word's sighting; see k_new_generation
  unsigned long long* taken;
  std::int64_t room;
  std::uint64_t target_mask;

  /// Place for words, of one row or several. By all lanes of a warp.
  __device__ RowPlace reserve(int count) const {
    unsigned long long first = 0;
    if ((threadIdx.x & 31) == 0) first = atomicAdd(taken, static_cast<unsigned long long>(count));
    first = __shfl_sync(0xffffffffu, first, 0);
    return {static_cast<std::int64_t>(first), static_cast<std::int64_t>(first) + count <= room};
  }
  __device__ void note(std::int32_t node, std::int64_t first, int count) const {
    firsts[node] = first;
    counts[node] = count;
  }
  __device__ void put(std::int64_t at, std::uint64_t word, std::uint8_t back_sector, std::uint64_t place) const {
    words[at] = word;
    targets[at] = static_cast<std::int32_t>(word & target_mask);
    back_sectors[at] = back_sector;
    order[at] = place;
  }
};

/// A reverse that its row lacks: it is the `number`-th that the row gets.
struct AddedArc {
  std::int32_t row, number;
  std::uint64_t word;
};

/// No arc's word: none is as long as the longest that there is a number for.
constexpr std::uint64_t k_unpaired = ~std::uint64_t{0};

/// Reverses that rows of `range` lack, in any order.
struct AddedArcs {
  IndexRange range;
  std::int32_t* counts;  ///< per row
  AddedArc* arcs;
  unsigned long long* count;
  std::int64_t room;

  /// Of a node's arcs from `first` on: the lane's own is the `i`-th of each 32 where bit i of `lacking` is set. By all
  /// threads of a block, of which one counts for all: additions to one place wait for one another.
  __device__ void add(const DeviceRows& rows, const ArcPacking& packing, std::int32_t node, std::int64_t first,
                      unsigned lacking) const {
    const int lane = threadIdx.x & 31, mine = __popc(lacking);
    std::int64_t at = place_for(mine);
    for (; lacking != 0; lacking &= lacking - 1, ++at) {
      const std::int64_t arc = first + 32 * (__ffs(static_cast<int>(lacking)) - 1) + lane;
      const std::int32_t row = rows.targets[arc] - range.begin, number = atomicAdd(&counts[row], 1);
      if (at < room) arcs[at] = {row, number, packing.reversed(node, rows.back_sectors[arc], rows.words[arc])};
    }
  }

 private:
  /// The first of as many places as a thread wants. By all threads of a block.
  __device__ std::int64_t place_for(int wanted) const {
    __shared__ unsigned long long firsts[32];  // of the warps
    const int lane = threadIdx.x & 31, warp = static_cast<int>(threadIdx.x) / 32;
    const int warps = static_cast<int>(blockDim.x) / 32, through = warp_sum_through(wanted);
    if (lane == 31) firsts[warp] = static_cast<unsigned long long>(through);
    __syncthreads();
    if (warp == 0) {
      const int own = lane < warps ? static_cast<int>(firsts[lane]) : 0, with_own = warp_sum_through(own);
      unsigned long long before = 0;
      if (lane == 31 && with_own > 0) before = atomicAdd(count, static_cast<unsigned long long>(with_own));
      before = __shfl_sync(0xffffffffu, before, 31);
      __syncwarp();
      firsts[lane] = before + static_cast<unsigned long long>(with_own - own);
    }
    __syncthreads();
    const auto place = static_cast<std::int64_t>(firsts[warp]) + through - wanted;
    __syncthreads();  // nobody looks there any more
    return place;
  }
};

/// Arcs of a row that are looked at before those whose reverses are missing are listed: bits of a word.
constexpr int k_arcs_at_once = 32 * 32;

/// Where a node is among `count` targets from `first` on, negative if it is not. `targets` is aligned, and a few beyond
/// the last can be read.
__device__ inline std::int64_t find_target(const std::int32_t* targets, std::int64_t first, int count,
                                           std::int32_t node) {
  const int4* const fours = reinterpret_cast<const int4*>(targets) + first / 4;
  const int before = static_cast<int>(first % 4), end = before + count;
  for (int at = 0; at < end; at += 4) {
    const int4 four = fours[at / 4];
    unsigned here =
        (four.x == node ? 1 : 0) | (four.y == node ? 2 : 0) | (four.z == node ? 4 : 0) | (four.w == node ? 8 : 0);
    if (at == 0) here &= ~0u << before;  // others' rows
    if (at + 4 > end) here &= (1u << (end - at)) - 1;
    if (here != 0) return first - before + at + __ffs(static_cast<int>(here)) - 1;
  }
  return -1;
}

// Nodes whose arcs a block pairs: neighbours, that have most of the rows that are searched in common, so that these are
// in the processor's cache.
constexpr int k_pair_threads = 512, k_nodes_per_block = 16;

/// Puts into `own`, of each arc to a larger node and of its reverse, the shorter one. Of nodes out of the range it is
/// enough to have the arcs that end within. \return those whose reverses are to be added, see AddedArcs
__device__ unsigned pair_arcs_of(const DeviceRows& rows, const ArcPacking& packing, std::int32_t node,
                                 std::int64_t first, int count, std::uint64_t* own, const AddedArcs& added) {
  unsigned lacking = 0;
  for (int i = threadIdx.x & 31; i < count; i += 32) {
    const std::int64_t arc = first + i;
    const std::int32_t target = rows.targets[arc];
    if (target <= node) continue;
    const std::int64_t reverse = find_target(rows.targets, rows.firsts[target], rows.counts[target], node);
    const std::uint64_t word = rows.words[arc];
    std::uint64_t kept = word;
    if (reverse >= 0) {
      const std::uint64_t back = rows.words[reverse];
      const std::uint64_t length_there = back & packing.length_mask, length_here = word & packing.length_mask;
      if (length_there < length_here) kept = packing.reversed(target, rows.back_sectors[reverse], back);
      own[reverse] = length_here < length_there ? packing.reversed(node, rows.back_sectors[arc], word) : back;
    } else if (added.range.holds(target)) {
      lacking |= 1u << i / 32;
    }
    own[arc] = kept;
  }
  return lacking;
}

/// Whether any of a block's rows, one a warp, has arcs from `begin` on. By all threads of the block, which go through
/// their rows together: those with short ones wait for the others.
__device__ inline bool any_has_more(int begin, int count) { return __syncthreads_or(begin < count ? 1 : 0) != 0; }

__global__ void __launch_bounds__(k_pair_threads)
    pair_arcs(DeviceRows rows, ArcPacking packing, std::int32_t nodes, std::uint64_t* own, AddedArcs added) {
  static_assert(k_nodes_per_block == k_pair_threads / 32);
  const std::int32_t node =
      static_cast<std::int32_t>(blockIdx.x) * k_nodes_per_block + static_cast<int>(threadIdx.x) / 32;
  const int count = node < nodes ? rows.counts[node] : 0;
  const std::int64_t row = count > 0 ? rows.firsts[node] : 0;
  for (int begin = 0; any_has_more(begin, count); begin += k_arcs_at_once) {
    const unsigned lacking =
        pair_arcs_of(rows, packing, node, row + begin, min(k_arcs_at_once, count - begin), own, added);
    added.add(rows, packing, node, row + begin, lacking);
  }
}

/// What has not been paired so far has no reverse.
__global__ void find_unpaired(DeviceRows rows, ArcPacking packing, std::int32_t nodes, std::uint64_t* own,
                              AddedArcs added) {
  const int lane = threadIdx.x & 31;
  const std::int32_t node =
      static_cast<std::int32_t>(blockIdx.x) * k_rows_per_block + static_cast<int>(threadIdx.x) / 32;
  const int count = node < nodes ? rows.counts[node] : 0;
  const std::int64_t row = count > 0 ? rows.firsts[node] : 0;
  for (int begin = 0; any_has_more(begin, count); begin += k_arcs_at_once) {
    const std::int64_t first = row + begin;
    unsigned lacking = 0;
    for (int i = lane; i < min(k_arcs_at_once, count - begin); i += 32) {
      if (own[first + i] != k_unpaired) continue;
      own[first + i] = rows.words[first + i];
      if (added.range.holds(rows.targets[first + i])) lacking |= 1u << i / 32;
    }
    added.add(rows, packing, node, first, lacking);
  }
}

__global__ void add_counts(const std::int32_t* counts, const std::int32_t* added, IndexRange range,
                           std::int64_t* totals, std::int64_t* added_totals) {
  const auto row = static_cast<std::int32_t>(blockIdx.x * blockDim.x + threadIdx.x);
  if (row > range.count()) return;
  totals[row] = row < range.count() ? counts[range.begin + row] + added[row] : 0;  // the scan's last becomes the sum
  added_totals[row] = row < range.count() ? added[row] : 0;
}

__global__ void gather_added(const AddedArc* added, std::int64_t count, const std::int64_t* first,
                             std::uint64_t* words) {
  const std::int64_t i = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i < count) words[first[added[i].row] + added[i].number] = added[i].word;
}

__global__ void shift_offsets(std::int64_t* offsets, std::size_t count, std::int64_t by) {
  const std::size_t i = static_cast<std::size_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i < count) offsets[i] += by;
}

/// A row's own arcs in the processor's order, then those that were added, sorted.
__global__ void write_rows(DeviceRows rows, IndexRange range, const std::uint64_t* own, const std::uint64_t* added,
                           const std::int64_t* added_first, const std::int64_t* offsets, std::uint64_t* words) {
  const int lane = threadIdx.x & 31;
  const std::int32_t row =
      static_cast<std::int32_t>(blockIdx.x) * k_rows_per_block + static_cast<int>(threadIdx.x) / 32;
  if (row >= range.count()) return;
  const std::int64_t first = rows.firsts[range.begin + row], to = offsets[row];
  const int count = rows.counts[range.begin + row];
  constexpr int k_at_hand = 128;
  __shared__ std::uint64_t orders[k_rows_per_block][k_at_hand];
  const std::uint64_t* order = rows.order + first;
  if (count <= k_at_hand) {  // it is looked through again and again
    std::uint64_t* const near = orders[threadIdx.x / 32];
    for (int i = lane; i < count; i += 32) near[i] = order[i];
    order = near;
    __syncwarp();
  }
  for (int i = lane; i < count; i += 32) words[to + place_in_order(order, count, i)] = own[first + i];
  const std::uint64_t* const others = added + added_first[row];
  const int other_count = static_cast<int>(added_first[row + 1] - added_first[row]);
  for (int i = lane; i < other_count; i += 32) {
    int rank = 0;
    for (int j = 0; j < other_count; ++j) rank += others[j] < others[i];
    words[to + count + rank] = others[i];
  }
}

/// Owns what DeviceRows shows.
class RowStore {
 public:
  RowStore(std::int32_t nodes, std::int64_t room, std::uint64_t target_mask, cudaStream_t stream)
      : stream_(stream),
        nodes_(nodes),
        room_(room),
        target_mask_(target_mask),
        firsts_(static_cast<std::size_t>(nodes), stream),
        counts_(static_cast<std::size_t>(nodes), stream),
        words_(static_cast<std::size_t>(room), stream),
        targets_(static_cast<std::size_t>(room) + k_read_beyond, stream),
        back_sectors_(static_cast<std::size_t>(room), stream),
        order_(static_cast<std::size_t>(room), stream),
        taken_(1, stream) {}

  void clear() {
    taken_.fill_bytes(0);
    counts_.fill_bytes(0);
  }
  DeviceRows view() {
    return {firsts_.data(), counts_.data(), words_.data(), targets_.data(), back_sectors_.data(),
            order_.data(),  taken_.data(),  room_,         target_mask_};
  }
  std::int32_t nodes() const { return nodes_; }
  std::int64_t room() const { return room_; }
  std::uint64_t target_mask() const { return target_mask_; }
  /// Waits for the stream.
  std::int64_t words_wanted() const {
    unsigned long long taken = 0;
    taken_.read({&taken, 1});
    return static_cast<std::int64_t>(taken);
  }

  void set_taken(std::int64_t words) {
    const auto taken = static_cast<unsigned long long>(words);
    copy(taken_.data(), &taken, 1);
    check_cuda(cudaStreamSynchronize(stream_), "copying rows");
  }
  /// For `room` words, of which `taken` are there.
  void make_room(std::int64_t taken, std::int64_t room) {
    if (room <= room_) return;
    const auto grow = [&](auto& buffer, std::int64_t size) {
      std::remove_reference_t<decltype(buffer)> larger(static_cast<std::size_t>(size), stream_);
      copy(larger.data(), buffer.data(), static_cast<std::size_t>(taken));
      buffer = std::move(larger);
    };
    grow(words_, room);
    grow(targets_, room + k_read_beyond);
    grow(back_sectors_, room);
    grow(order_, room);
    room_ = room;
  }

  /// Adds rows that were found elsewhere.
  void append(const std::vector<std::int32_t>& nodes, const FoundRows& found) {
    const std::int64_t first = words_wanted();
    const auto taken = static_cast<unsigned long long>(first) + found.word_count;
    copy(taken_.data(), &taken, 1);
    if (static_cast<std::int64_t>(taken) <= room_) {
      std::vector<std::int32_t> targets(found.word_count);
      for (std::size_t i = 0; i < targets.size(); ++i)
        targets[i] = static_cast<std::int32_t>(found.words[i] & target_mask_);
      const std::vector<std::uint64_t> order(found.word_count, k_new_generation);  // it is theirs already
      copy(words_.data() + first, found.words, found.word_count);
      copy(targets_.data() + first, targets.data(), targets.size());
      copy(back_sectors_.data() + first, found.back_sectors, found.word_count);
      copy(order_.data() + first, order.data(), order.size());
      std::int64_t at = first;
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        copy(firsts_.data() + nodes[i], &at, 1);
        copy(counts_.data() + nodes[i], found.counts + i, 1);
        check_cuda(cudaStreamSynchronize(stream_), "copying rows");
        at += found.counts[i];
      }
    }
    check_cuda(cudaStreamSynchronize(stream_), "copying rows");
  }

 private:
  static constexpr std::int64_t k_read_beyond = 4;  ///< see find_target

  template <class Number>
  void copy(Number* to, const Number* from, std::size_t count) {
    check_cuda(cudaMemcpyAsync(to, from, count * sizeof(Number), cudaMemcpyDefault, stream_), "copying rows");
  }

  cudaStream_t stream_;
  std::int32_t nodes_;
  std::int64_t room_;
  std::uint64_t target_mask_;
  DeviceBuffer<std::int64_t> firsts_;
  DeviceBuffer<std::int32_t> counts_;
  DeviceBuffer<std::uint64_t> words_;
  DeviceBuffer<std::int32_t> targets_;
  DeviceBuffer<std::uint8_t> back_sectors_;
  DeviceBuffer<std::uint64_t> order_;
  DeviceBuffer<unsigned long long> taken_;
};

/// The arcs of a range of a graph's nodes in compressed rows, on the device.
class DeviceUnion {
 public:
  DeviceUnion(const ArcPacking& packing, RowStore& rows, IndexRange range, cudaStream_t stream)
      : stream_(stream), range_(range), offsets_(static_cast<std::size_t>(range.count()) + 1, stream) {
    const std::int64_t found = rows.words_wanted();
    const auto places = static_cast<std::size_t>(range.count()) + 1;
    DeviceBuffer<std::uint64_t> own(static_cast<std::size_t>(found), stream);
    DeviceBuffer<std::int32_t> added_counts(places, stream);
    DeviceBuffer<AddedArc> added(static_cast<std::size_t>(found), stream);
    DeviceBuffer<unsigned long long> added_count(1, stream);
    DeviceBuffer<std::int64_t> totals(places, stream), added_totals(places, stream), added_first(places, stream);
    own.fill_bytes(0xff);  // k_unpaired
    added_counts.fill_bytes(0);
    added_count.fill_bytes(0);
    const AddedArcs adding{range, added_counts.data(), added.data(), added_count.data(), found};
    const auto pair_blocks = static_cast<unsigned>(rows.nodes() / k_nodes_per_block + 1);
    pair_arcs<<<pair_blocks, k_pair_threads, 0, stream>>>(rows.view(), packing, rows.nodes(), own.data(), adding);
    find_unpaired<<<row_blocks(rows.nodes()), k_block_threads, 0, stream>>>(rows.view(), packing, rows.nodes(),
                                                                            own.data(), adding);
    check_cuda(cudaGetLastError(), "pairing arcs");
    const auto place_blocks = static_cast<unsigned>(range.count() / k_block_threads + 1);
    add_counts<<<place_blocks, k_block_threads, 0, stream>>>(rows.view().counts, added_counts.data(), range,
                                                             totals.data(), added_totals.data());
    check_cuda(cudaGetLastError(), "counting arcs");
    add_up(totals, offsets_, stream);
    add_up(added_totals, added_first, stream);
    unsigned long long missing = 0;
    check_cuda(cudaMemcpyAsync(&count_, offsets_.data() + range.count(), sizeof count_, cudaMemcpyDeviceToHost, stream),
               "counting arcs");
    added_count.read({&missing, 1});
    words_ = DeviceBuffer<std::uint64_t>(static_cast<std::size_t>(count_), stream);
    DeviceBuffer<std::uint64_t> others(static_cast<std::size_t>(missing), stream);
    if (missing > 0) {
      const auto blocks = static_cast<unsigned>((missing + k_block_threads - 1) / k_block_threads);
      gather_added<<<blocks, k_block_threads, 0, stream>>>(added.data(), static_cast<std::int64_t>(missing),
                                                           added_first.data(), others.data());
      check_cuda(cudaGetLastError(), "gathering reverses");
    }
    if (range.count() == 0) return;
    write_rows<<<row_blocks(range.count()), k_block_threads, 0, stream>>>(
        rows.view(), range, own.data(), others.data(), added_first.data(), offsets_.data(), words_.data());
    check_cuda(cudaGetLastError(), "writing rows");
  }

  std::int64_t count() const { return count_; }
  /// To a whole graph's arrays, of which `before` words belong to earlier ranges.
  void copy(HostCopies& copies, std::int64_t before, std::int64_t* offsets, std::uint64_t* words) {
    if (before > 0) {
      const auto blocks = static_cast<unsigned>(range_.count() / k_block_threads + 1);
      shift_offsets<<<blocks, k_block_threads, 0, stream_>>>(offsets_.data(), offsets_.size(), before);
      check_cuda(cudaGetLastError(), "placing rows");
    }
    const std::size_t first = range_.begin == 0 ? 0 : 1;  // the first is the last of the range before
    copies.to_host(offsets_.data() + first, offsets_.size() - first, offsets + range_.begin + first);
    copies.to_host(words_.data(), static_cast<std::size_t>(count_), words + before);
  }

 private:
  static unsigned row_blocks(std::int32_t rows) {
    return static_cast<unsigned>((rows + k_rows_per_block - 1) / k_rows_per_block);
  }

  cudaStream_t stream_;
  IndexRange range_;
  DeviceBuffer<std::int64_t> offsets_;
  DeviceBuffer<std::uint64_t> words_;
  std::int64_t count_ = 0;
};

}  // namespace
}  // namespace saddleback
