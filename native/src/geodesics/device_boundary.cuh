#pragma once
// Rows of arcs that several devices found, each those of its own range of nodes. To pair its arcs with their reverses a
// device needs of the others' rows only the arcs that end in its range: few, since nodes are numbered by place.

#include <utility>
#include <vector>

#include "geodesics/device_union.cuh"

namespace saddleback {
namespace {

/// Of the rows of `nodes`, the arcs that end in `ends`, as rows of their own.
__global__ void select_arcs(DeviceRows rows, IndexRange nodes, IndexRange ends, DeviceRows chosen) {
  const int lane = threadIdx.x & 31;
  const std::int32_t node =
      nodes.begin + static_cast<std::int32_t>(blockIdx.x) * k_rows_per_block + static_cast<int>(threadIdx.x) / 32;
  if (node >= nodes.end) return;
  const std::int64_t first = rows.firsts[node];
  const int count = rows.counts[node];
  const auto chosen_of = [&](int base) {
    const bool is_chosen = base + lane < count && ends.holds(rows.targets[first + base + lane]);
    return __ballot_sync(0xffffffffu, is_chosen);
  };
  int total = 0;
  for (int base = 0; base < count; base += 32) total += __popc(chosen_of(base));
  const RowPlace row = chosen.reserve(total);
  if (lane == 0) chosen.note(node, row.first, total);
  if (!row.fits) return;
  std::int64_t at = row.first;
  for (int base = 0; base < count; base += 32) {
    const unsigned taken = chosen_of(base);
    const std::int64_t mine = first + base + lane;
    if (taken >> lane & 1)
      chosen.put(at + __popc(taken & ((1u << lane) - 1)), rows.words[mine], rows.back_sectors[mine], rows.order[mine]);
    at += __popc(taken);
  }
}

__global__ void shift_firsts(std::int64_t* firsts, IndexRange nodes, std::int64_t by) {
  const std::int32_t node = nodes.begin + static_cast<std::int32_t>(blockIdx.x * blockDim.x + threadIdx.x);
  if (node < nodes.end) firsts[node] += by;
}

/// Arcs that one device holds and another needs.
struct ChosenRows {
  RowStore rows;
  std::int64_t words;
};

/// Of the rows of `nodes`, what another device needs whose range is `ends`. Complete on return.
inline ChosenRows rows_across(RowStore& rows, IndexRange nodes, IndexRange ends, cudaStream_t stream) {
  constexpr std::int64_t k_first_guess = 16;  // of as many one: ranges are compact
  const auto blocks = static_cast<unsigned>((nodes.count() + k_rows_per_block - 1) / k_rows_per_block);
  for (std::int64_t room = rows.room() / k_first_guess + 1;;) {
    RowStore chosen(rows.nodes(), room, stream);
    chosen.set_target_mask(rows.target_mask());
    chosen.clear();
    if (blocks > 0) select_arcs<<<blocks, k_block_threads, 0, stream>>>(rows.view(), nodes, ends, chosen.view());
    check_cuda(cudaGetLastError(), "choosing arcs");
    const std::int64_t wanted = chosen.words_wanted();
    if (wanted <= room) return {std::move(chosen), wanted};
    room = wanted;
  }
}

/// What `there`, on another device, holds of the rows of `nodes`.
struct RowsThere {
  int device;
  IndexRange nodes;
  ChosenRows* chosen;
};

/// Adds to `rows`, of `device`, what others have chosen for it. Complete on return.
inline void add_rows(RowStore& rows, int device, const std::vector<RowsThere>& others, cudaStream_t stream) {
  std::int64_t taken = rows.words_wanted(), more = 0;
  for (const RowsThere& other : others) more += other.chosen->words;
  rows.make_room(taken, taken + more);
  const DeviceRows to = rows.view();
  const auto copy = [&]<class Number>(Number* into, const Number* from, std::int64_t count, int from_device) {
    if (count == 0) return;
    check_cuda(
        cudaMemcpyPeerAsync(into, device, from, from_device, static_cast<std::size_t>(count) * sizeof(Number), stream),
        "copying between devices");
  };
  for (const RowsThere& other : others) {
    const IndexRange nodes = other.nodes;
    if (nodes.count() == 0) continue;
    const std::int64_t words = other.chosen->words;
    const DeviceRows from = other.chosen->rows.view();
    copy(to.words + taken, from.words, words, other.device);
    copy(to.targets + taken, from.targets, words, other.device);
    copy(to.back_sectors + taken, from.back_sectors, words, other.device);
    copy(to.counts + nodes.begin, from.counts + nodes.begin, nodes.count(), other.device);
    copy(to.firsts + nodes.begin, from.firsts + nodes.begin, nodes.count(), other.device);
    const auto blocks = static_cast<unsigned>((nodes.count() + k_block_threads - 1) / k_block_threads);
    shift_firsts<<<blocks, k_block_threads, 0, stream>>>(to.firsts, nodes, taken);
    check_cuda(cudaGetLastError(), "placing rows");
    taken += words;
  }
  rows.note_wanted(taken);
  check_cuda(cudaStreamSynchronize(stream), "copying between devices");
}

}  // namespace
}  // namespace saddleback
