#pragma once
// Rows of arcs on the device as they are found, and their union with their reverses: the CUDA counterpart of
// arc_symmetry.

#include <algorithm>
#include <cstdint>
#include <cub/device/device_scan.cuh>
#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/transform_iterator.h>
#include <vector>

#include "geodesics/cuda/device_sighting_order.cuh"
#include "geodesics/graph/arcs_abi.h"
#include "support/cuda/device_buffer.h"
#include "support/cuda/device_launch.cuh"
#include "support/cuda/device_scratch.cuh"
#include "support/cuda/host_copies.h"
#include "support/cuda/index_range.cuh"
#include "support/cuda/warp.cuh"

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
  std::uint32_t* order;  ///< in the generation, of the word's sighting; see k_new_generation
  unsigned long long* taken;
  std::int64_t room;
  std::uint64_t target_mask;
  const std::int32_t* left = nullptr;  ///< nodes whose rows are still to be found; null: none

  /// Tells whether all were found, and there was room for them.
  __device__ bool are_there() const { return (!left || *left == 0) && static_cast<std::int64_t>(*taken) <= room; }
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
  __device__ void put(std::int64_t at, std::uint64_t word, std::uint8_t back_sector, std::uint32_t place) const {
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

/// Reverses that rows of `range` lack, in any order.
struct AddedArcs {
  IndexRange range;
  std::int32_t* counts;  ///< per row
  AddedArc* arcs;
  unsigned long long* count;
  std::int64_t room;
  std::uint8_t* seen;  ///< per arc of the rows: 1 when it was paired, or found to lack its reverse

  /// Notes it without loads that come later having to wait: nobody reads it before all is paired.
  __device__ void note_seen(std::int64_t arc) const {
    asm volatile("st.global.u8 [%0], %1;" ::"l"(seen + arc), "r"(1));
  }

  /// Adds some of the arcs of `Rows` nodes, from the `begin`-th of each on, `32 / Rows` times 32 at most: bit i of
  /// `lacking` is set where the lane's own of the i-th 32 is to be added. By all threads of a block, of which one
  /// counts for all: additions to one place wait for one another.
  template <int Rows>
  __device__ void add(const DeviceRows& rows, const ArcPacking& packing, std::int32_t node, int begin,
                      unsigned lacking) const {
    constexpr int k_bits = 32 / Rows;
    const int lane = threadIdx.x & 31, mine = __popc(lacking);
    std::int64_t at = place_for(mine);
    for (; lacking != 0; lacking &= lacking - 1, ++at) {
      const int bit = __ffs(static_cast<int>(lacking)) - 1;
      const std::int32_t from = node + bit / k_bits;
      const std::int64_t arc = rows.firsts[from] + begin + 32 * (bit % k_bits) + lane;
      const std::int32_t row = rows.targets[arc] - range.begin, number = atomicAdd(&counts[row], 1);
      if (at < room) arcs[at] = {row, number, packing.reversed(from, rows.back_sectors[arc], rows.words[arc])};
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

/// Returns where a node is among `count` targets from `first` on, negative if it is not. `targets` is aligned, and a
/// few beyond the last can be read.
__device__ inline std::int64_t find_target(const std::int32_t* targets, std::int64_t first, int count,
                                           std::int32_t node) {
  constexpr int k_at_once = 8;  // what memory gives in one piece
  const int4* const fours = reinterpret_cast<const int4*>(targets + first / k_at_once * k_at_once);
  const int before = static_cast<int>(first % k_at_once), end = before + count;
  const auto is = [&](const int4& four) {
    return (four.x == node ? 1u : 0) | (four.y == node ? 2u : 0) | (four.z == node ? 4u : 0) |
           (four.w == node ? 8u : 0);
  };
  for (int at = 0; at < end; at += k_at_once) {
    const int4 four = fours[at / 4], next = fours[at / 4 + 1];
    unsigned here = is(four) | is(next) << 4;
    if (at == 0) here &= ~0u << before;  // others' rows
    if (at + k_at_once > end) here &= (1u << (end - at)) - 1;
    if (here != 0) return first - before + at + __ffs(static_cast<int>(here)) - 1;
  }
  return -1;
}

// Nodes whose arcs a block pairs: neighbors, that have most of the rows that are searched in common, so that these are
// in the processor's cache.
constexpr int k_pair_threads = 512, k_nodes_per_block = 16;

/// Makes of each arc to a larger node and its reverse the shorter one: nobody else looks at these two words. Of nodes
/// out of the range it is enough to have the arcs that end within. \return those whose reverses are to be added, see
/// AddedArcs
__device__ unsigned pair_arcs_of(const DeviceRows& rows, const ArcPacking& packing, std::int32_t node, std::int64_t row,
                                 int begin, int end, const AddedArcs& added) {
  unsigned lacking = 0;
  for (int i = begin + static_cast<int>(threadIdx.x & 31); i < end; i += 32) {
    const std::int64_t arc = row + i;
    const std::int32_t target = rows.targets[arc];
    if (target <= node) continue;
    const std::uint64_t word = rows.words[arc];
    const std::int64_t reverse = find_target(rows.targets, rows.firsts[target], rows.counts[target], node);
    if (reverse >= 0) {
      const std::uint64_t back = rows.words[reverse];
      const std::uint64_t length_there = back & packing.length_mask, length_here = word & packing.length_mask;
      if (length_there < length_here) rows.words[arc] = packing.reversed(target, rows.back_sectors[reverse], back);
      if (length_here < length_there) rows.words[reverse] = packing.reversed(node, rows.back_sectors[arc], word);
      added.note_seen(reverse);
    } else if (added.range.holds(target)) {
      lacking |= 1u << (i - begin) / 32;
    }
    added.note_seen(arc);
  }
  return lacking;
}

/// Tells whether any of a block's rows, one a warp, has arcs from `begin` on. By all threads of the block, which go
/// through their rows together: those with short ones wait for the others.
__device__ inline bool any_has_more(int begin, int count) { return __syncthreads_or(begin < count ? 1 : 0) != 0; }

__global__ void __launch_bounds__(k_pair_threads)
    pair_arcs(DeviceRows rows, ArcPacking packing, std::int32_t nodes, AddedArcs added) {
  static_assert(k_nodes_per_block == k_pair_threads / 32);
  if (!rows.are_there()) return;
  const std::int32_t node =
      static_cast<std::int32_t>(blockIdx.x) * k_nodes_per_block + static_cast<int>(threadIdx.x) / 32;
  const int count = node < nodes ? rows.counts[node] : 0;
  const std::int64_t row = count > 0 ? rows.firsts[node] : 0;
  for (int begin = 0; any_has_more(begin, count); begin += k_arcs_at_once) {
    const unsigned lacking = pair_arcs_of(rows, packing, node, row, begin, min(begin + k_arcs_at_once, count), added);
    added.add<1>(rows, packing, node, begin, lacking);
  }
}

constexpr int k_unpaired_rows_per_warp = 4;

/// Finds what has not been paired so far, which has no reverse.
__global__ void find_unpaired(DeviceRows rows, ArcPacking packing, std::int32_t nodes, AddedArcs added) {
  if (!rows.are_there()) return;
  constexpr int k_rows = k_unpaired_rows_per_warp, k_bits = 32 / k_rows;
  const int lane = threadIdx.x & 31;
  const std::int32_t warp =
      static_cast<std::int32_t>(blockIdx.x) * k_rows_per_block + static_cast<int>(threadIdx.x) / 32;
  int counts[k_rows], most = 0;
  for (int r = 0; r < k_rows; ++r) {
    counts[r] = k_rows * warp + r < nodes ? rows.counts[k_rows * warp + r] : 0;
    most = max(most, counts[r]);
  }
  for (int begin = 0; any_has_more(begin, most); begin += 32 * k_bits) {
    unsigned lacking = 0;
    for (int r = 0; r < k_rows; ++r) {
      const std::int64_t row = counts[r] > 0 ? rows.firsts[k_rows * warp + r] : 0;
      for (int b = 0; b < k_bits && begin + 32 * b < counts[r]; ++b) {
        const int i = begin + 32 * b + lane;
        if (i < counts[r] && added.seen[row + i] == 0 && added.range.holds(rows.targets[row + i]))
          lacking |= 1u << (k_bits * r + b);
      }
    }
    added.add<k_rows>(rows, packing, k_rows * warp, begin, lacking);
  }
}

/// Words of a row, or of all before it, and those of them that were added.
struct RowSizes {
  std::int64_t all, added;
};
struct AddSizes {
  __host__ __device__ RowSizes operator()(const RowSizes& a, const RowSizes& b) const {
    return {a.all + b.all, a.added + b.added};
  }
};
/// Holds the sizes of the rows of a range, by number.
struct SizesOfRows {
  const std::int32_t *counts, *added;
  IndexRange range;
  __host__ __device__ RowSizes operator()(std::int32_t row) const {
    if (row >= range.count()) return {0, 0};  // the sum's place
    return {std::int64_t{counts[range.begin + row]} + added[row], added[row]};
  }
};

/// Puts what was added in any order together row by row, unless there was too little room.
__global__ void gather_added(AddedArcs added, const RowSizes* before, std::uint64_t* words) {
  const std::int64_t i = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  const auto count = static_cast<std::int64_t>(*added.count);
  if (i >= count || count > added.room) return;
  const AddedArc arc = added.arcs[i];
  words[before[arc.row].added + arc.number] = arc.word;
}

/// Holds where all arcs go.
struct UnitedRows {
  const RowSizes* before;
  const std::uint64_t* others;  ///< that were added, row by row
  std::int64_t room_for_others;
  std::int64_t* offsets;
  std::uint64_t* words;
  std::int64_t room;
};

__global__ void shift_offsets(std::int64_t* offsets, std::size_t count, std::int64_t by) {
  const std::size_t i = static_cast<std::size_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i < count) offsets[i] += by;
}

/// Writes the rows of a part of a range, by number. A row's own arcs in the processor's order, then those that were
/// added, sorted; and where each row begins, and the last ends.
__global__ void write_rows(DeviceRows rows, IndexRange range, IndexRange part, UnitedRows united) {
  const int lane = threadIdx.x & 31;
  const std::int32_t row =
      part.begin + static_cast<std::int32_t>(blockIdx.x) * k_rows_per_block + static_cast<int>(threadIdx.x) / 32;
  const RowSizes all = united.before[range.count()];
  const bool fits = all.all <= united.room && all.added <= united.room_for_others;
  if (row >= part.end || !fits || !rows.are_there()) return;
  const RowSizes here = united.before[row], next = united.before[row + 1];
  const std::int64_t first = rows.firsts[range.begin + row], to = here.all;
  const int count = rows.counts[range.begin + row];
  if (lane == 0) united.offsets[row] = to;
  if (lane == 1 && row + 1 == range.count()) united.offsets[row + 1] = next.all;
  std::uint64_t* const words = united.words;
  constexpr int k_at_hand = 128;
  __shared__ std::uint32_t orders[k_rows_per_block][k_at_hand];
  const std::uint32_t* order = rows.order + first;
  if (count <= k_at_hand) {  // it is looked through again and again
    std::uint32_t* const near = orders[threadIdx.x / 32];
    for (int i = lane; i < count; i += 32) near[i] = order[i];
    order = near;
    __syncwarp();
  }
  for (int i = lane; i < count; i += 32) words[to + place_in_order(order, count, i)] = rows.words[first + i];
  const std::uint64_t* const others = united.others + here.added;
  const int other_count = static_cast<int>(next.added - here.added);
  for (int i = lane; i < other_count; i += 32) {
    int rank = 0;
    for (int j = 0; j < other_count; ++j) rank += others[j] < others[i];
    words[to + count + rank] = others[i];
  }
}

/// Owns what DeviceRows shows.
class RowStore {
 public:
  RowStore(std::int32_t nodes, std::int64_t room, cudaStream_t stream)
      : stream_(stream),
        nodes_(nodes),
        room_(room),
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
    wanted_ = k_unknown;
  }
  DeviceRows view() {
    return {firsts_.data(), counts_.data(), words_.data(), targets_.data(), back_sectors_.data(),
            order_.data(),  taken_.data(),  room_,         target_mask_};
  }
  std::int32_t nodes() const { return nodes_; }
  std::int64_t room() const { return room_; }
  std::uint64_t target_mask() const { return target_mask_; }
  void set_target_mask(std::uint64_t mask) { target_mask_ = mask; }
  /// Returns the words of all rows. Waits for the stream, unless it is known.
  std::int64_t words_wanted() const {
    return wanted_ != k_unknown ? wanted_ : static_cast<std::int64_t>(taken_.value_at(0));
  }
  void note_wanted(std::int64_t words) { wanted_ = words; }
  /// Makes room for `room` words, of which `taken` are there.
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
    wanted_ = first + static_cast<std::int64_t>(found.word_count);
    if (wanted_ <= room_) {
      std::vector<std::int32_t> targets(found.word_count);
      for (std::size_t i = 0; i < targets.size(); ++i)
        targets[i] = static_cast<std::int32_t>(found.words[i] & target_mask_);
      const std::vector<std::uint32_t> order(found.word_count, k_new_generation);  // it is theirs already
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
  static constexpr std::int64_t k_read_beyond = 8;  ///< see find_target
  static constexpr std::int64_t k_unknown = -1;

  template <class Number>
  void copy(Number* to, const Number* from, std::size_t count) {
    check_cuda(cudaMemcpyAsync(to, from, count * sizeof(Number), cudaMemcpyDefault, stream_), "copying rows");
  }

  cudaStream_t stream_;
  std::int32_t nodes_;
  std::int64_t room_;
  std::uint64_t target_mask_ = 0;
  DeviceBuffer<std::int64_t> firsts_;
  DeviceBuffer<std::int32_t> counts_;
  DeviceBuffer<std::uint64_t> words_;
  DeviceBuffer<std::int32_t> targets_;
  DeviceBuffer<std::uint8_t> back_sectors_;
  DeviceBuffer<std::uint32_t> order_;
  DeviceBuffer<unsigned long long> taken_;
  std::int64_t wanted_ = k_unknown;
};

/// The arcs of a range of a graph's nodes in compressed rows, on the device.
class DeviceUnion {
 public:
  /// Takes memory for so many words of all nodes' rows.
  DeviceUnion(std::int32_t nodes, IndexRange range, std::int64_t room, cudaStream_t stream)
      : stream_(stream),
        nodes_(nodes),
        range_(range),
        added_counts_(static_cast<std::size_t>(range.count()), stream),
        added_count_(1, stream),
        before_(static_cast<std::size_t>(range.count()) + 1, stream),
        offsets_(static_cast<std::size_t>(range.count()) + 1, stream) {
    take_room(room, room / 4);
  }

  /// Gives an arc and its reverse the same length, adds those that have none, and writes all, unless by then rows are
  /// not all there. What the device still does to them comes first.
  void unite(const ArcPacking& packing, const DeviceRows& rows) {
    if (static_cast<std::int64_t>(words_.size()) < rows.room) take_room(rows.room, rows.room / 4);
    added_counts_.fill_bytes(0);
    added_count_.fill_bytes(0);
    seen_.fill_bytes(0);
    const AddedArcs adding{range_,           added_counts_.data(), added_.data(), added_count_.data(),
                           room_for_added(), seen_.data()};
    const auto pair_blocks = static_cast<unsigned>(nodes_ / k_nodes_per_block + 1);
    pair_arcs<<<pair_blocks, k_pair_threads, 0, stream_>>>(rows, packing, nodes_, adding);
    const unsigned unpaired_blocks = row_blocks(nodes_ / k_unpaired_rows_per_warp + 1);
    find_unpaired<<<unpaired_blocks, k_block_threads, 0, stream_>>>(rows, packing, nodes_, adding);
    check_cuda(cudaGetLastError(), "pairing arcs");
    add_up_sizes({rows.counts, added_counts_.data(), range_});
    added_up_.record(stream_);
    gather_added<<<blocks_for(room_for_added()), k_threads, 0, stream_>>>(adding, before_.data(), others_.data());
    const UnitedRows united{before_.data(),  others_.data(), room_for_added(),
                            offsets_.data(), words_.data(),  static_cast<std::int64_t>(words_.size())};
    if (range_.count() == 0) return offsets_.fill_bytes(0);
    for (std::size_t p = 0; p < k_parts; ++p) {
      const IndexRange rows_of_part = part(p);
      if (rows_of_part.count() > 0)
        write_rows<<<row_blocks(rows_of_part.count()), k_block_threads, 0, stream_>>>(rows, range_, rows_of_part,
                                                                                      united);
      written_[p].record(stream_);
    }
    check_cuda(cudaGetLastError(), "writing rows");
  }
  /// Tells whether there was room for all words. Waits until they are counted; they are still being written.
  bool fits(cudaStream_t aside) {
    check_cuda(cudaEventSynchronize(added_up_), "waiting for the device");
    for (std::size_t p = 0; p <= k_parts; ++p)
      sizes_[p] = before_.value_at(static_cast<std::size_t>(part(p).begin), aside);
    return all().all <= static_cast<std::int64_t>(words_.size()) && all().added <= room_for_added();
  }
  /// Makes as much as it was seen to take.
  void make_room() {
    take_room(std::max(all().all, static_cast<std::int64_t>(words_.size())), std::max(all().added, room_for_added()));
  }

  std::int64_t count() const { return all().all; }
  /// Copies to a whole graph's arrays, of which `before` words belong to earlier ranges. Words are copied while later
  /// ones are written.
  void copy(HostCopies& copies, std::int64_t before, std::int64_t* offsets, std::uint64_t* words) {
    if (before > 0) {
      const auto blocks = static_cast<unsigned>(range_.count() / k_block_threads + 1);
      shift_offsets<<<blocks, k_block_threads, 0, stream_>>>(offsets_.data(), offsets_.size(), before);
      check_cuda(cudaGetLastError(), "placing rows");
    }
    const std::size_t first = range_.begin == 0 ? 0 : 1;  // the first is the last of the range before
    for (std::size_t p = 0; p < k_parts; ++p) {
      const std::int64_t begin = sizes_[p].all, end = sizes_[p + 1].all;
      copies.to_host(words_.data() + begin, static_cast<std::size_t>(end - begin), words + before + begin, written_[p]);
    }
    copies.to_host(offsets_.data() + first, offsets_.size() - first, offsets + range_.begin + first);
  }

 private:
  /// Counts the parts of the range's rows, which are written one part after the other.
  static constexpr std::size_t k_parts = 4;
  /// Rows by number; the one after the last is empty.
  IndexRange part(std::size_t number) const {
    const auto begin = [&](std::size_t p) {
      return static_cast<std::int32_t>(static_cast<std::int64_t>(std::min(p, k_parts)) * range_.count() / k_parts);
    };
    return {begin(number), begin(number + 1)};
  }
  const RowSizes& all() const { return sizes_[k_parts]; }
  std::int64_t room_for_added() const { return static_cast<std::int64_t>(added_.size()); }
  void take_room(std::int64_t words, std::int64_t added) {
    words_ = DeviceBuffer<std::uint64_t>(static_cast<std::size_t>(words), stream_);
    seen_ = DeviceBuffer<std::uint8_t>(static_cast<std::size_t>(words), stream_);
    added_ = DeviceBuffer<AddedArc>(static_cast<std::size_t>(added), stream_);
    others_ = DeviceBuffer<std::uint64_t>(static_cast<std::size_t>(added), stream_);
  }
  static unsigned row_blocks(std::int32_t rows) {
    return static_cast<unsigned>((rows + k_rows_per_block - 1) / k_rows_per_block);
  }

  void add_up_sizes(const SizesOfRows& sizes) {
    const auto all = thrust::make_transform_iterator(thrust::counting_iterator<std::int32_t>(0), sizes);
    with_scratch(stream_, "adding up arcs", [&](void* scratch, std::size_t& bytes) {
      return cub::DeviceScan::ExclusiveScan(scratch, bytes, all, before_.data(), AddSizes{}, RowSizes{0, 0},
                                            static_cast<int>(before_.size()), stream_);
    });
  }

  cudaStream_t stream_;
  std::int32_t nodes_;
  IndexRange range_;
  DeviceBuffer<std::int32_t> added_counts_;  ///< per row of the range
  DeviceBuffer<AddedArc> added_;
  DeviceBuffer<unsigned long long> added_count_;
  DeviceBuffer<std::uint64_t> others_;  ///< words that were added, row by row
  DeviceBuffer<std::uint8_t> seen_;     ///< per word of the rows
  DeviceBuffer<RowSizes> before_;       ///< of all rows before each, and before the end
  DeviceBuffer<std::int64_t> offsets_;
  DeviceBuffer<std::uint64_t> words_;
  StreamEvent added_up_, written_[k_parts];
  RowSizes sizes_[k_parts + 1] = {};  ///< before each part, and of all
};

}  // namespace
}  // namespace saddleback
