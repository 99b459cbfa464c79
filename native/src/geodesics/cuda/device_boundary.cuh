#pragma once
// Rows of arcs that several devices found, each those of its own range of nodes. To pair its arcs with their reverses a
// device needs of the others' rows only the arcs that end in its range: few, since nodes are numbered by place.

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "geodesics/cuda/device_union.cuh"

namespace saddleback {
namespace {

/// An arc that one device has and another needs.
struct ArcAcross {
  std::uint64_t word;
  std::uint8_t back_sector;
};
/// The arcs of one row, among all that the other device needs.
struct RowAcross {
  std::int64_t first;
  std::int32_t count;
};
/// All that another device needs, whose range is `ends`.
struct ArcsAcross {
  IndexRange ends;
  RowAcross* rows;  ///< by number in the range of who has them
  ArcAcross* arcs;
  unsigned long long* count;
};

/// Selects, of the rows of `nodes`, the arcs that end in others' ranges; room for `room` for each. Rows that have none
/// are left as they are.
__global__ void select_arcs(DeviceRows rows, IndexRange nodes, const ArcsAcross* others, int other_count,
                            std::int64_t room) {
  const int lane = threadIdx.x & 31;
  const std::int32_t number =
      static_cast<std::int32_t>(blockIdx.x) * k_rows_per_block + static_cast<int>(threadIdx.x) / 32;
  if (number >= nodes.count()) return;
  const std::int64_t first = rows.firsts[nodes.begin + number];
  const int count = rows.counts[nodes.begin + number];
  bool ends_within = true;
  for (int i = lane; i < count; i += 32) ends_within &= nodes.holds(rows.targets[first + i]);
  if (__all_sync(0xffffffffu, ends_within)) return;
  for (int o = 0; o < other_count; ++o) {
    const ArcsAcross other = others[o];
    const auto chosen_of = [&](int base) {
      const bool is_chosen = base + lane < count && other.ends.holds(rows.targets[first + base + lane]);
      return __ballot_sync(0xffffffffu, is_chosen);
    };
    int total = 0;
    for (int base = 0; base < count; base += 32) total += __popc(chosen_of(base));
    if (total == 0) continue;
    unsigned long long place = 0;
    if (lane == 0) place = atomicAdd(other.count, static_cast<unsigned long long>(total));
    auto at = static_cast<std::int64_t>(__shfl_sync(0xffffffffu, place, 0));
    if (lane == 0) other.rows[number] = {at, total};
    if (at + total > room) continue;
    for (int base = 0; base < count; base += 32) {
      const unsigned taken = chosen_of(base);
      const std::int64_t mine = first + base + lane;
      if (taken >> lane & 1)
        other.arcs[at + __popc(taken & ((1u << lane) - 1))] = {rows.words[mine], rows.back_sectors[mine]};
      at += __popc(taken);
    }
  }
}

/// Holds what a device has that others need. Memory is taken when it is made, which may be while rows are found.
class ArcsForOthers {
 public:
  /// Guesses that of as many arcs of all so many end in another's range: ranges are compact.
  static constexpr std::int64_t k_of_as_many = 16;

  /// `ends`: the others' ranges.
  ArcsForOthers(IndexRange nodes, std::vector<IndexRange> ends, std::int64_t arcs, cudaStream_t stream)
      : nodes_(nodes), ends_(std::move(ends)), stream_(stream), rows_(size(nodes.count()), stream), counts_(size(1)) {
    if (ends_.empty()) return;
    device_counts_ = DeviceBuffer<unsigned long long>(size(1), stream);
    take_room(arcs / k_of_as_many + 1);
  }

  /// Waits for the stream.
  void choose(const DeviceRows& rows) {
    if (ends_.empty() || nodes_.count() == 0) return;
    while (true) {
      rows_.fill_bytes(0);
      device_counts_.fill_bytes(0);
      const auto blocks = static_cast<unsigned>((nodes_.count() + k_rows_per_block - 1) / k_rows_per_block);
      select_arcs<<<blocks, k_block_threads, 0, stream_>>>(rows, nodes_, others_.data(), static_cast<int>(ends_.size()),
                                                           room_);
      check_cuda(cudaGetLastError(), "choosing arcs");
      device_counts_.read(counts_);
      const auto wanted = static_cast<std::int64_t>(std::ranges::max(counts_));
      if (wanted <= room_) return;
      take_room(wanted);
    }
  }
  IndexRange nodes() const { return nodes_; }
  /// Returns what the `other`-th of the others needs: a row for each of nodes(), and the arcs.
  const RowAcross* rows(std::size_t other) const {
    return rows_.data() + other * static_cast<std::size_t>(nodes_.count());
  }
  std::span<const ArcAcross> arcs(std::size_t other) const {
    return {arcs_.data() + other * static_cast<std::size_t>(room_), static_cast<std::size_t>(counts_[other])};
  }

 private:
  /// Returns the size of so many numbers for each of the others.
  std::size_t size(std::int64_t each) const { return ends_.size() * static_cast<std::size_t>(each); }
  void take_room(std::int64_t room) {
    room_ = room;
    arcs_ = DeviceBuffer<ArcAcross>(size(room), stream_);
    std::vector<ArcsAcross> others;
    for (std::size_t o = 0; o < ends_.size(); ++o)
      others.push_back({ends_[o], rows_.data() + o * static_cast<std::size_t>(nodes_.count()),
                        arcs_.data() + o * static_cast<std::size_t>(room), device_counts_.data() + o});
    others_ = DeviceBuffer<ArcsAcross>(others, stream_);
  }

  IndexRange nodes_;
  std::vector<IndexRange> ends_;
  cudaStream_t stream_;
  std::int64_t room_ = 0;
  DeviceBuffer<RowAcross> rows_;
  DeviceBuffer<ArcAcross> arcs_;
  DeviceBuffer<unsigned long long> device_counts_;
  DeviceBuffer<ArcsAcross> others_;
  std::vector<unsigned long long> counts_;
};

/// Holds what another device, which has the rows of `nodes`, has chosen for this one.
struct ArcsThere {
  int device;
  IndexRange nodes;
  const RowAcross* rows;
  std::span<const ArcAcross> arcs;
};

/// Puts them behind the first `taken` words.
__global__ void add_arcs(DeviceRows rows, std::int64_t taken, IndexRange nodes, const RowAcross* more,
                         const ArcAcross* arcs, std::int64_t arc_count) {
  const std::int64_t i = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i < nodes.count()) rows.note(nodes.begin + static_cast<std::int32_t>(i), more[i].first + taken, more[i].count);
  if (i < arc_count) rows.put(taken + i, arcs[i].word, arcs[i].back_sector, 0);
}

/// Adds to `rows`, of `device`, what others have chosen for it. They keep it until the stream has run.
inline void add_rows(RowStore& rows, int device, const std::vector<ArcsThere>& others, cudaStream_t stream) {
  std::int64_t taken = rows.words_wanted();
  std::size_t arc_count = 0, row_count = 0;
  for (const ArcsThere& other : others) {
    arc_count += other.arcs.size();
    row_count += static_cast<std::size_t>(other.nodes.count());
  }
  rows.make_room(taken, taken + static_cast<std::int64_t>(arc_count));
  DeviceBuffer<RowAcross> rows_here(row_count, stream);
  DeviceBuffer<ArcAcross> arcs_here(arc_count, stream);
  const auto copy = [&]<class Item>(Item* to, std::span<const Item> from, int from_device) {
    if (from.empty()) return;
    check_cuda(cudaMemcpyPeerAsync(to, device, from.data(), from_device, from.size_bytes(), stream),
               "copying between devices");
  };
  RowAcross* next_row = rows_here.data();
  ArcAcross* next_arc = arcs_here.data();
  for (const ArcsThere& other : others) {
    const auto nodes = static_cast<std::size_t>(other.nodes.count());
    const auto arcs = static_cast<std::int64_t>(other.arcs.size());
    copy(next_row, std::span(other.rows, nodes), other.device);
    copy(next_arc, other.arcs, other.device);
    add_arcs<<<blocks_for(std::max<std::int64_t>(other.nodes.count(), arcs)), k_threads, 0, stream>>>(
        rows.view(), taken, other.nodes, next_row, next_arc, arcs);
    check_cuda(cudaGetLastError(), "adding arcs");
    next_row += nodes;
    next_arc += arcs;
    taken += arcs;
  }
  rows.note_wanted(taken);
}

}  // namespace
}  // namespace saddleback
