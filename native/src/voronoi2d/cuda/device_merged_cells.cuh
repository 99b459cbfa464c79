#pragma once
// All cells at once by divide and conquer, for sites that lie along curves: there the circles through neighbors are
// far larger than a tile, and meet sites without end. Along a curve, though, two parts side by side have few edges
// between them.
//
// Every site is a part. Who is the second of two to come to where they meet merges them and goes on; the first has
// nothing left to do.

#include "support/cuda/device_stream.h"
#include "support/cuda/index_range.cuh"
#include "voronoi2d/cuda/device_cells.cuh"
#include "voronoi2d/cuda/device_merge.cuh"

namespace saddleback::voronoi2d {
namespace {

/// Says what came of merging all.
enum class MergeOutcome : int { fully, too_slow, not_told };

/// Ranks in a row, as one part.
struct MergedRun {
  MergedPart part;
  std::int32_t first, last;
};

/// Holds who merges with whom, as found on the way up: runs in the order of the places, which differ least. After
/// [apetrei2014].
struct MergeTree {
  MergedMesh mesh;
  const std::uint32_t* places;  ///< by rank, never falling
  std::int32_t count;
  MergedPart* parts;      ///< two for each border, which has the number of the rank before it
  std::int32_t* arrived;  ///< by border: the other end of the run that came first; -1: none
  MergedRun* waiting;     ///< runs that end where their block does
  int *waiting_count, *taken;
  int* failed;  ///< a `MergeOutcome`, the first

  /// Returns the size of the step over a border; no two that matter are equal.
  __device__ std::uint64_t step(std::int32_t border) const {
    return static_cast<std::uint64_t>(places[border] ^ places[border + 1]) << 32 |
           static_cast<std::uint32_t>(border ^ (border + 1));
  }

  /// Merges as long as others have come first. arrive(border, end) returns the end of who did, -1 when none did. False
  /// where `is_within(border)` is.
  template <class IsWithin, class Arrive>
  __device__ bool climb(MergedRun& run, IsWithin&& is_within, Arrive&& arrive) const {
    while (run.first > 0 || run.last < count - 1) {
      const bool goes_on = run.first == 0 || (run.last < count - 1 && step(run.last) < step(run.first - 1));  // or back
      const std::int32_t border = goes_on ? run.last : run.first - 1;
      if (!is_within(border)) return false;
      MergedPart* const both = parts + 2 * static_cast<std::int64_t>(border);
      both[goes_on ? 0 : 1] = run.part;
      const std::int32_t end = arrive(border, goes_on ? run.first : run.last);
      if (end < 0) break;
      (goes_on ? run.last : run.first) = end;
      Merger merger(mesh);
      if (!merger.merge(both[0], both[1], run.part)) {
        fail(merger.took_too_long() ? MergeOutcome::too_slow : MergeOutcome::not_told);
        break;
      }
    }
    return true;
  }
  /// Records the first failure: who stops because others failed says nothing new.
  __device__ void fail(MergeOutcome why) const { atomicCAS(failed, 0, static_cast<int>(why)); }
};

constexpr int k_merge_threads = 64, k_merge_each = 2, k_merge_sites = k_merge_threads * k_merge_each;

/// Runs within the sites of a block.
__global__ void __launch_bounds__(k_merge_threads, 512 / k_merge_threads) merge_near_sites(MergeTree tree) {
  __shared__ std::int32_t arrived[k_merge_sites];
  const std::int32_t begin = static_cast<std::int32_t>(blockIdx.x) * k_merge_sites,
                     end = min(begin + k_merge_sites, tree.count);
  for (int i = threadIdx.x; i < k_merge_sites; i += k_merge_threads) arrived[i] = -1;
  __syncthreads();
  for (int k = 0; k < k_merge_each; ++k) {
    const std::int32_t site = begin + static_cast<int>(threadIdx.x) * k_merge_each + k;
    if (site >= end) break;
    MergedRun run{Merger(tree.mesh).part_of(site), site, site};
    const bool ends_here = tree.climb(
        run, [&](std::int32_t border) { return border >= begin && border + 1 < end; },
        [&](std::int32_t border, std::int32_t other_end) {
          __threadfence_block();
          const std::int32_t came = atomicExch(&arrived[border - begin], other_end);
          __threadfence_block();
          return came;
        });
    if (!ends_here) tree.waiting[atomicAdd(tree.waiting_count, 1)] = run;
  }
  __syncthreads();
  for (std::int32_t i = begin + static_cast<int>(threadIdx.x); i < end; i += k_merge_threads)
    tree.arrived[i] = arrived[i - begin];
}

/// The rest: a lane of a warp for each, since no two do the same.
__global__ void __launch_bounds__(k_threads, 2) merge_far_sites(MergeTree tree) {
  if (threadIdx.x % 32 != 0) return;
  const int count = *tree.waiting_count;
  for (int i = atomicAdd(tree.taken, 1); i < count; i = atomicAdd(tree.taken, 1)) {
    if (*static_cast<volatile int*>(tree.failed)) return;
    MergedRun run = tree.waiting[i];
    tree.climb(
        run, [](std::int32_t) { return true; },
        [&](std::int32_t border, std::int32_t other_end) {
          __threadfence();
          const std::int32_t came = atomicExch(&tree.arrived[border], other_end);
          __threadfence();
          return came;
        });
  }
}

/// Finds for each site a half-edge of all those from it, whichever.
__global__ void find_leaving(MergedMesh mesh, std::int32_t edges) {
  const std::int32_t edge = thread_number();
  if (edge >= edges) return;
  const HalfEdge half = mesh.halves[2 * edge];
  if (!half.is_used) return;
  mesh.leaving[half.to] = 2 * edge + 1;
  mesh.leaving[mesh.halves[2 * edge + 1].to] = 2 * edge;
}

/// A site's neighbors from the triangles about it. Where several have one circle, the edges between these go.
class CellLister {
 public:
  __device__ CellLister(const MergedMesh& mesh, std::int32_t rank) : mesh_(mesh), rank_(rank), at_(mesh.point(rank)) {}

  /// Returns false when something cannot be decided, or there are too many.
  __device__ bool list(int most, const DeviceLists& lists) {
    const std::int32_t leaving = mesh_.leaving[rank_];
    if (leaving < 0) return false;
    HalfEdge* const halves = mesh_.halves;
    std::int32_t half = leaving, first = leaving, lowest = -1;
    std::int32_t before = halves[halves[leaving].before].to;
    bool was_inside = is_triangle(before, halves[leaving].to);
    int count = 0, gaps = 0;
    do {
      const HalfEdge edge = halves[half];
      const std::int32_t after = halves[edge.next].to;
      const bool is_inside = is_triangle(edge.to, after);
      bool is_known = true;
      const bool is_side =
          !was_inside || !is_inside ||
          known_circle_sign(at_, mesh_.point(before), mesh_.point(edge.to), mesh_.point(after), is_known) != 0;
      if (!is_known) return false;
      halves[half].is_side = is_side;
      count += is_side;
      gaps += !is_inside;
      if (!was_inside) first = half;
      if (is_side && (lowest < 0 || edge.to < halves[lowest].to)) lowest = half;
      before = edge.to;
      was_inside = is_inside;
      half = edge.next;
    } while (half != leaving);
    if (gaps > 1 || count < 2 || count > most) return false;
    return write(gaps == 1 ? first : lowest, count, gaps == 1, lists);
  }

 private:
  __device__ bool is_triangle(std::int32_t a, std::int32_t b) const {
    return turn_sign(at_, mesh_.point(a), mesh_.point(b)) > 0;
  }

  __device__ bool write(std::int32_t first, int count, bool is_open, const DeviceLists& lists) const {
    std::int32_t* to = lists.slots + static_cast<std::int64_t>(rank_) * k_slots;
    if (count > k_slots) {
      const unsigned begin = atomicAdd(lists.pool_taken, static_cast<unsigned>(count));
      if (begin + static_cast<unsigned>(count) > lists.pool_room) return false;
      *to = static_cast<std::int32_t>(begin);
      to = lists.pool + begin;
    }
    std::int32_t half = first;
    do {
      const HalfEdge edge = mesh_.halves[half];
      if (edge.is_side) *to++ = edge.to;
      half = edge.next;
    } while (half != first);
    lists.counts[rank_] = count;
    lists.is_open[rank_] = is_open;
    return true;
  }

  const MergedMesh& mesh_;
  std::int32_t rank_;
  Point2 at_;
};

__global__ void __launch_bounds__(k_threads, 2)
    list_merged_cells(MergeTree tree, IndexRange ranks, int most_neighbors, DeviceLists lists) {
  const std::int32_t rank = ranks.begin + thread_number();
  if (rank >= ranks.end || *tree.failed) return;
  if (!CellLister(tree.mesh, rank).list(most_neighbors, lists)) tree.fail(MergeOutcome::not_told);
}

/// The Delaunay triangulation of all sites.
class MergedSites {
 public:
  /// `most_steps`: of one merge. A million sites along one curve need less than a hundred, evenly in a square some
  /// thousands; a hundred thousand are a tenth of a second.
  MergedSites(const double2* sites, const std::uint32_t* places, std::int32_t count, int most_steps,
              cudaStream_t stream)
      : stream_(stream),
        halves_(2 * MergedMesh::k_edges * static_cast<std::size_t>(count), stream),
        leaving_(static_cast<std::size_t>(count), stream),
        arrived_(static_cast<std::size_t>(count), stream),
        parts_(2 * static_cast<std::size_t>(count), stream),
        waiting_(2 * static_cast<std::size_t>(block_count(count)), stream),
        counters_(3, stream),
        tree_{{sites, halves_.data(), leaving_.data(), counters_.data() + 2, most_steps},
              places,
              count,
              parts_.data(),
              arrived_.data(),
              waiting_.data(),
              counters_.data(),
              counters_.data() + 1,
              counters_.data() + 2} {}

  /// `far_blocks`: as many as the device has room for.
  void merge(int far_blocks) {
    counters_.fill_bytes(0);
    merge_near_sites<<<static_cast<unsigned>(block_count(tree_.count)), k_merge_threads, 0, stream_>>>(tree_);
    check_cuda(cudaGetLastError(), "merging sites");
    merge_far_sites<<<static_cast<unsigned>(far_blocks), k_threads, 0, stream_>>>(tree_);
    check_cuda(cudaGetLastError(), "merging sites");
  }

  /// Fills the lists of some cells. Waits for the device; poll() may throw meanwhile. Not told are also the neighbors
  /// of a cell that has too many.
  template <class Poll>
  MergeOutcome list(IndexRange ranks, int most_neighbors, const DeviceLists& lists, Poll&& poll) {
    const std::int32_t edges = MergedMesh::k_edges * tree_.count;
    find_leaving<<<blocks_for(edges), k_threads, 0, stream_>>>(tree_.mesh, edges);
    check_cuda(cudaGetLastError(), "listing cells");
    list_merged_cells<<<blocks_for(ranks.count()), k_threads, 0, stream_>>>(tree_, ranks, most_neighbors, lists);
    check_cuda(cudaGetLastError(), "listing cells");
    int* const failed = counters_.data() + 2;
    wait_polling(
        stream_, [&](cudaStream_t) { poll(); },
        [&](cudaStream_t aside) { (void)cudaMemsetAsync(failed, 1, sizeof *failed, aside); });
    return static_cast<MergeOutcome>(counters_.value_at(2));
  }

 private:
  static std::int32_t block_count(std::int32_t count) { return (count + k_merge_sites - 1) / k_merge_sites; }

  cudaStream_t stream_;
  DeviceBuffer<HalfEdge> halves_;
  DeviceBuffer<std::int32_t> leaving_, arrived_;
  DeviceBuffer<MergedPart> parts_;
  DeviceBuffer<MergedRun> waiting_;
  DeviceBuffer<int> counters_;
  MergeTree tree_;
};

}  // namespace
}  // namespace saddleback::voronoi2d
