#pragma once
// The cells as one half-edge structure on the device, numbered as by half_edges.

#include "voronoi2d/circumcentre_point.h"
#include "voronoi2d/device_cells.cuh"

namespace saddleback::voronoi2d {
namespace {

/// Rows of neighbours, counter-clockwise; of an open cell from the border on.
struct DeviceCells {
  std::int32_t count;
  const double2* at;
  const std::int32_t* original;
  const std::int32_t* offsets;
  const std::int32_t* neighbours;
  const std::uint8_t* is_open;

  __device__ Point2 point(std::int32_t rank) const {
    const double2 p = at[rank];
    return {p.x, p.y};
  }
};

struct DeviceNumbers {
  std::int32_t* next_corners;
  std::int32_t* corner_vertices;
  std::int32_t* side_edges;
  int2* edges;
  int2* edge_sites;
  double2* vertices;
  const int* misfits;  ///< found before
  int* misfits_here;

  __device__ bool failed_before() const { return *misfits != 0; }
};

/// Neighbours row after row; also counts the edges of a cell, which are those to higher ranks.
__global__ void gather_rows(DeviceLists lists, std::int32_t count, const std::int32_t* offsets,
                            std::int32_t* neighbours, std::int32_t* edge_counts) {
  const std::int32_t cell = thread_number();
  if (cell >= count) return;
  const std::int32_t begin = offsets[cell], size = offsets[cell + 1] - begin;
  const std::int32_t* from = lists.slots + static_cast<std::int64_t>(cell) * k_slots;
  if (size > k_slots) from = lists.pool + *from;
  int edges = 0;
  for (std::int32_t k = 0; k < size; ++k) {
    neighbours[begin + k] = from[k];
    edges += from[k] > cell;
  }
  edge_counts[cell] = edges;
}

/// Notes a misfit when a sum is not what it has to be; nothing is done from then on.
__global__ void expect_sum(const std::int32_t* sum, std::int32_t wanted, int* misfits) {
  if (*sum != wanted) *misfits = 1;
}

__device__ inline bool winds_once(const DeviceCells& cells, std::int32_t cell) {
  const std::int32_t first = cells.offsets[cell], last = cells.offsets[cell + 1] - 1;
  if (last <= first) return false;
  const double2 p = cells.at[cell];
  const auto is_above = [&](std::int32_t rank) {
    const double2 q = cells.at[rank];
    return q.y > p.y || (q.y == p.y && q.x > p.x);
  };
  const bool is_open = cells.is_open[cell];
  bool before = is_above(cells.neighbours[is_open ? first : last]);
  int crossings = 0;
  for (std::int32_t side = first; side <= last; ++side) {
    const bool now = is_above(cells.neighbours[side]);
    crossings += now != before;
    before = now;
  }
  if (!is_open) return crossings == 2;
  return crossings <= 1 && orient_2d(cells.point(cells.neighbours[last]), cells.point(cell),
                                     cells.point(cells.neighbours[first])) != predicates::Sign::negative;
}

__global__ void join_sides(DeviceCells cells, const std::int32_t* edges_before, DeviceNumbers numbers) {
  const std::int32_t cell = thread_number();
  if (cell >= cells.count || numbers.failed_before()) return;
  const std::int32_t first = cells.offsets[cell], end = cells.offsets[cell + 1];
  bool fits = winds_once(cells, cell);
  std::int32_t edge = edges_before[cell];
  for (std::int32_t side = first; side < end; ++side) {
    const std::int32_t other = cells.neighbours[side];
    if (other < cell) continue;
    const std::int32_t other_first = cells.offsets[other], other_end = cells.offsets[other + 1];
    std::int32_t twin = other_first;
    while (twin < other_end && cells.neighbours[twin] != cell) ++twin;
    if (twin == other_end) {
      fits = false;
      break;
    }
    numbers.next_corners[side] = twin == other_first ? other_end - 1 : twin - 1;
    const std::int32_t before = side == first ? end - 1 : side - 1;
    numbers.next_corners[twin] = before;
    numbers.edges[edge] = {before, side};
    numbers.side_edges[side] = numbers.side_edges[twin] = edge;
    numbers.edge_sites[edge] = {cells.original[cell], cells.original[other]};
    ++edge;
  }
  if (cells.is_open[cell]) numbers.corner_vertices[end - 1] = -1;
  if (!fits) *numbers.misfits_here = 1;
}

/// Calls found(corner) for the corners of the vertices that belong to a cell: no lower rank is about them.
template <class Found>
__device__ void for_own_vertices(const DeviceCells& cells, const std::int32_t* next_corners, std::int32_t cell,
                                 Found&& found) {
  const std::int32_t first = cells.offsets[cell], last = cells.offsets[cell + 1] - 1;
  for (std::int32_t corner = first; corner <= last - cells.is_open[cell]; ++corner) {
    const std::int32_t other = cells.neighbours[corner], third = cells.neighbours[corner == last ? first : corner + 1];
    if (min(other, third) < cell) continue;
    std::int32_t lowest = cell;
    for (std::int32_t walk = next_corners[corner]; walk != corner; walk = next_corners[walk])
      lowest = min(lowest, cells.neighbours[walk]);
    if (lowest == cell) found(corner);
  }
}

__global__ void count_vertices(DeviceCells cells, DeviceNumbers numbers, std::int32_t* counts) {
  const std::int32_t cell = thread_number();
  if (cell >= cells.count || numbers.failed_before()) return;
  std::int32_t mine = 0;
  for_own_vertices(cells, numbers.next_corners, cell, [&](std::int32_t) { ++mine; });
  counts[cell] = mine;
}

__global__ void add_vertices(DeviceCells cells, const std::int32_t* vertices_before, DeviceNumbers numbers) {
  const std::int32_t cell = thread_number();
  if (cell >= cells.count || numbers.failed_before()) return;
  std::int32_t vertex = vertices_before[cell];
  for_own_vertices(cells, numbers.next_corners, cell, [&](std::int32_t corner) {
    const std::int32_t second = numbers.next_corners[corner], third = numbers.next_corners[second];
    std::int32_t about[3] = {cell, cells.neighbours[corner], cells.neighbours[second]};
    numbers.corner_vertices[corner] = numbers.corner_vertices[second] = numbers.corner_vertices[third] = vertex;
    if (numbers.next_corners[third] != corner) {  // three of many, evenly about it
      int size = 0;
      std::int32_t walk = corner;
      do {
        numbers.corner_vertices[walk] = vertex;
        ++size;
        walk = numbers.next_corners[walk];
      } while (walk != corner);
      for (int k = 0; k < size; ++k, walk = numbers.next_corners[walk]) {
        if (k == size - 1) about[0] = cells.neighbours[walk];
        if (k == size / 3 - 1) about[1] = cells.neighbours[walk];
        if (k == 2 * size / 3 - 1) about[2] = cells.neighbours[walk];
      }
    }
    const Point2 centre = circumcentre_point(cells.point(about[0]), cells.point(about[1]), cells.point(about[2]));
    numbers.vertices[vertex++] = {centre.x, centre.y};
  });
}

__global__ void add_ends(std::int32_t count, DeviceNumbers numbers) {
  const std::int32_t edge = thread_number();
  if (edge >= count || numbers.failed_before()) return;
  const int2 corners = numbers.edges[edge];
  const int2 ends = {numbers.corner_vertices[corners.x], numbers.corner_vertices[corners.y]};
  if (ends.x < 0) {
    const int2 sites = numbers.edge_sites[edge];
    numbers.edges[edge] = {ends.y, ends.x};
    numbers.edge_sites[edge] = {sites.y, sites.x};
  } else {
    numbers.edges[edge] = ends;
  }
}

inline void add_up(const DeviceBuffer<std::int32_t>& counts, DeviceBuffer<std::int32_t>& sums, cudaStream_t stream) {
  const auto count = static_cast<int>(counts.size());
  with_scratch(stream, "adding up", [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceScan::ExclusiveSum(scratch, bytes, counts.data(), sums.data(), count, stream);
  });
}

/// Rows, then numbers, of all cells. Nothing waits for the device; whether all fits is known at the end.
class DeviceDiagram {
 public:
  DeviceDiagram(std::int32_t cells, std::int32_t sides, cudaStream_t stream)
      : stream_(stream),
        count_(cells),
        sides_(sides),
        edges_(sides / 2),
        vertices_(edges_ - cells + 1),
        neighbours_(size(sides), stream),
        corner_vertices_(size(sides), stream),
        side_edges_(size(sides), stream),
        edge_vertices_(size(edges_), stream),
        edge_sites_(size(edges_), stream),
        vertex_places_(size(std::max(vertices_, 0)), stream),
        misfits_(2, stream) {}

  /// By Euler's formula.
  bool can_be() const { return sides_ % 2 == 0 && vertices_ >= 0 && edges_ <= 3 * static_cast<std::int64_t>(count_); }
  const std::int32_t* neighbours() const { return neighbours_.data(); }
  PlaneTwinSizes sizes() const { return {count_, edges_, vertices_}; }

  /// Copies what is done as soon as it is.
  void number(const DeviceCells& cells, const DeviceLists& lists, HostCopies& copies, const PlaneTwinArrays& to) {
    const auto places = static_cast<std::size_t>(count_) + 1;
    DeviceBuffer<std::int32_t> next_corners(size(sides_), stream_), counts(places, stream_), before(places, stream_);
    misfits_.fill_bytes(0);
    counts.fill_bytes(0);
    const DeviceNumbers numbers{next_corners.data(), corner_vertices_.data(), side_edges_.data(), edge_vertices_.data(),
                                edge_sites_.data(),  vertex_places_.data(),   misfits_.data(),    misfits_.data() + 1};
    const unsigned blocks = blocks_for(count_);
    gather_rows<<<blocks, k_threads, 0, stream_>>>(lists, count_, cells.offsets, neighbours_.data(), counts.data());
    check_cuda(cudaGetLastError(), "gathering cells");
    add_up(counts, before, stream_);
    expect(before, edges_);
    join_sides<<<blocks, k_threads, 0, stream_>>>(cells, before.data(), numbers);
    check_cuda(cudaGetLastError(), "joining cells");
    copy(copies, side_edges_, to.side_edges);
    expect_sum<<<1, 1, 0, stream_>>>(misfits_.data() + 1, 0, misfits_.data());
    check_cuda(cudaGetLastError(), "joining cells");
    count_vertices<<<blocks, k_threads, 0, stream_>>>(cells, numbers, counts.data());
    check_cuda(cudaGetLastError(), "counting vertices");
    add_up(counts, before, stream_);
    expect(before, vertices_);
    add_vertices<<<blocks, k_threads, 0, stream_>>>(cells, before.data(), numbers);
    check_cuda(cudaGetLastError(), "placing vertices");
    copy(copies, vertex_places_, to.vertices);
    copy(copies, corner_vertices_, to.corner_vertices);
    add_ends<<<blocks_for(edges_), k_threads, 0, stream_>>>(edges_, numbers);
    check_cuda(cudaGetLastError(), "numbering edges");
    copy(copies, edge_vertices_, to.edges);
    copy(copies, edge_sites_, to.edge_sites);
  }

  /// Waits for the stream.
  bool fits() const {
    int misfits[2];
    misfits_.read(misfits);
    return misfits[0] == 0;
  }

 private:
  static std::size_t size(std::int32_t count) { return static_cast<std::size_t>(count); }

  void expect(const DeviceBuffer<std::int32_t>& sums, std::int32_t total) {
    expect_sum<<<1, 1, 0, stream_>>>(sums.data() + count_, total, misfits_.data());
    check_cuda(cudaGetLastError(), "counting");
  }
  template <class Number>
  static void copy(HostCopies& copies, const DeviceBuffer<Number>& from, void* to) {
    copies.to_host(from.data(), from.size(), to);
  }

  cudaStream_t stream_;
  std::int32_t count_, sides_, edges_, vertices_;
  DeviceBuffer<std::int32_t> neighbours_, corner_vertices_, side_edges_;
  DeviceBuffer<int2> edge_vertices_, edge_sites_;
  DeviceBuffer<double2> vertex_places_;
  DeviceBuffer<int> misfits_;
};

}  // namespace
}  // namespace saddleback::voronoi2d
