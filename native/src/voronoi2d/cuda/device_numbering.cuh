#pragma once
// The cells as one half-edge structure on the device, numbered as by half_edges.

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "support/cuda/device_stream.h"
#include "support/cuda/index_range.cuh"
#include "voronoi2d/cuda/device_cells.cuh"
#include "voronoi2d/cuda/device_kept.cuh"
#include "voronoi2d/cuda/device_numbers_elsewhere.cuh"
#include "voronoi2d/cuda/device_plane_part.cuh"
#include "voronoi2d/cuda/diagram_abi.h"
#include "voronoi2d/diagram/circumcenter_point.h"
#include "voronoi2d/weighted/weighted_wave.h"

namespace saddleback::voronoi2d {
namespace {

/// A side is known by the neighbor; negative where the corner behind it is at infinity. No side: nobody's neighbor.
constexpr std::int32_t k_no_side = std::numeric_limits<std::int32_t>::min();
__device__ constexpr std::int32_t open_side(std::int32_t neighbor) { return ~neighbor; }
__device__ constexpr std::int32_t neighbor_of(std::int32_t side) { return side < 0 ? ~side : side; }

/// Rows of sides, counter-clockwise. Of all cells or, where some are numbered elsewhere, of those numbered here and
/// their neighbors at least.
struct DeviceCells {
  std::int32_t count;
  IndexRange mine;
  const double2* at;
  const double* weights;  ///< null where all weigh the same
  const std::int32_t* original;
  const std::int32_t* offsets;
  const std::int32_t* sides;  ///< see open_side

  __device__ Point2 point(std::int32_t rank) const {
    const double2 p = at[rank];
    return {p.x, p.y};
  }
  /// Returns the cell of this thread, of one thread for each cell.
  __device__ std::int32_t of_thread() const { return mine.begin + thread_number(); }
  __device__ predicates::WeightedPoint2 weighted(std::int32_t rank) const {
    return {at[rank].x, at[rank].y, weights[rank]};
  }
  __device__ std::int32_t neighbor(std::int32_t side) const { return neighbor_of(sides[side]); }
  __device__ bool is_open(std::int32_t side) const { return sides[side] < 0; }
  /// The side of the neighbor towards a cell; the end of the neighbor's row when it has none.
  __device__ std::int32_t twin_side(std::int32_t cell, std::int32_t side) const {
    const std::int32_t other = neighbor(side), end = offsets[other + 1];
    std::int32_t twin = offsets[other];
    while (twin < end && !(neighbor(twin) == cell && (!weights || are_twins(cell, side, other, twin)))) ++twin;
    return twin;
  }
  // Of several sides between two cells the twins are next to the same third ones: no two of three curves around a cell
  // cross more than twice.
  __device__ bool are_twins(std::int32_t cell, std::int32_t side, std::int32_t other, std::int32_t twin) const {
    return third_after(cell, side) == third_before(other, twin) && third_before(cell, side) == third_after(other, twin);
  }
  /// The third cell about the corner behind a side, -1 at infinity.
  __device__ std::int32_t third_after(std::int32_t cell, std::int32_t side) const {
    return is_open(side) ? -1 : neighbor(side + 1 == offsets[cell + 1] ? offsets[cell] : side + 1);
  }
  __device__ std::int32_t third_before(std::int32_t cell, std::int32_t side) const {
    const std::int32_t before = corner_before(cell, side);
    return is_open(before) ? -1 : neighbor(before);
  }
  /// The corner before a side, in the cell that has it.
  __device__ std::int32_t corner_before(std::int32_t cell, std::int32_t side) const {
    return side == offsets[cell] ? offsets[cell + 1] - 1 : side - 1;
  }
};

/// Vertices that the processor places: number and sites, from the one with the lowest rank on, counter-clockwise.
struct RoughVertices {
  int4* vertices;
  int* count;
  int room;
};

struct DeviceNumbers {
  std::int32_t* next_corners;
  std::int32_t* corner_vertices;
  std::int32_t* side_edges;
  int2* edges;
  int2* edge_sites;
  double2* vertices;
  RoughVertices rough;
  const int* misfits;  ///< found before
  int* misfits_here;
  std::int32_t first_edge, first_vertex;                 ///< of those that are numbered here
  DeviceNumberList edges_elsewhere, vertices_elsewhere;  ///< of sides that are numbered elsewhere
  int* asks_for_all;                                     ///< whether rows of more than neighbors are needed

  __device__ bool failed_before() const { return *misfits != 0; }
  /// Calls work(side) for sides in a row, until others have failed: those of a cell that has a million of them take its
  /// thread a second.
  template <class Work>
  __device__ void for_sides(std::int32_t side, std::int32_t end, Work&& work) const {
    constexpr std::int32_t k_at_once = 1 << 10;
    while (true) {
      for (const std::int32_t stop = end - side > k_at_once ? side + k_at_once : end; side < stop; ++side) work(side);
      if (side >= end || *static_cast<const volatile int*>(misfits) != 0) return;
    }
  }
};

/// Sides row after row; also counts the edges of a cell, which are those to higher ranks. Rows next to cells that are
/// gathered elsewhere are sent to others, and theirs are not known yet.
template <bool HasOthers>
__global__ void gather_rows(DeviceLists lists, IndexRange cells, const std::int32_t* offsets, std::int32_t* sides,
                            std::int32_t* edge_counts, DeviceNumbers numbers, DeviceNumberList told) {
  const std::int32_t cell = cells.begin + thread_number();
  if (cell >= cells.end) return;
  const std::int32_t begin = offsets[cell], size = offsets[cell + 1] - begin;
  const std::int32_t* from = lists.slots + static_cast<std::int64_t>(cell) * k_slots;
  if (size > k_slots) from = lists.pool + *from;
  int edges = 0;
  bool is_told = false;
  numbers.for_sides(0, size, [&](std::int32_t k) {
    const std::int32_t other = neighbor_of(from[k]);
    const bool opens = k + 1 == size && lists.is_open[cell];  // else the list says where
    sides[begin + k] = opens ? open_side(from[k]) : from[k];
    edges += other > cell;
    if (HasOthers && !cells.holds(other)) {
      is_told = true;
      for (std::int32_t side = offsets[other]; side < offsets[other + 1]; ++side) sides[side] = k_no_side;
    }
  });
  edge_counts[cell] = edges;
  for (std::int32_t side = begin; is_told && side < begin + size; ++side) told.add(side, sides[side]);
}

/// Notes a misfit when a sum is not what it has to be; nothing is done from then on.
__global__ void expect_sum(const std::int32_t* sum, std::int32_t wanted, int* misfits) {
  if (*sum != wanted) *misfits = 1;
}

/// Tells whether the neighbors of a cell do, or of an open one no further; see check_open_cells.
__device__ inline bool winds_once(const DeviceCells& cells, std::int32_t cell, const DeviceNumbers& numbers) {
  const std::int32_t first = cells.offsets[cell], last = cells.offsets[cell + 1] - 1;
  if (last <= first) return false;
  const double2 p = cells.at[cell];
  const auto is_above = [&](std::int32_t rank) {
    const double2 q = cells.at[rank];
    return q.y > p.y || (q.y == p.y && q.x > p.x);
  };
  const bool is_open = cells.is_open(last);
  bool before = is_above(cells.neighbor(is_open ? first : last));
  int crossings = 0;
  numbers.for_sides(first, last + 1, [&](std::int32_t side) {
    const bool now = is_above(cells.neighbor(side));
    crossings += now != before;
    before = now;
  });
  return is_open ? crossings <= 1 : crossings == 2;
}

/// Tells what is left to tell of open cells, so that it costs the others nothing.
__global__ void check_open_cells(DeviceCells cells, const std::uint8_t* is_open, int* misfits) {
  const std::int32_t cell = cells.of_thread();
  if (cell >= cells.mine.end || !is_open[cell]) return;
  const std::int32_t first = cells.offsets[cell], last = cells.offsets[cell + 1] - 1;
  const auto at = [&](std::int32_t side) { return cells.point(cells.neighbor(side)); };
  if (last > first && turn_sign(at(last), cells.point(cell), at(first)) < 0) *misfits = 1;
}

/// Edges belong to the lower of their cells. `edges_before`: those numbered here.
template <bool HasOthers>
__global__ void join_sides(DeviceCells cells, const std::int32_t* edges_before, DeviceNumbers numbers) {
  const std::int32_t cell = cells.of_thread();
  if (cell >= cells.mine.end || numbers.failed_before()) return;
  const std::int32_t first = cells.offsets[cell], end = cells.offsets[cell + 1];
  bool fits = cells.weights || winds_once(cells, cell, numbers);  // with weights they are known to
  std::int32_t edge = numbers.first_edge + edges_before[cell];
  numbers.for_sides(first, end, [&](std::int32_t side) {
    const std::int32_t other = cells.neighbor(side);
    if (other < cell && cells.mine.holds(other)) return;
    const std::int32_t twin = cells.twin_side(cell, side);
    if (twin == cells.offsets[other + 1]) {
      fits = false;
      return;
    }
    numbers.next_corners[side] = cells.corner_before(other, twin);
    const bool is_elsewhere = HasOthers && !cells.mine.holds(other);
    // More than three about a vertex are not all neighbors of a cell.
    if (is_elsewhere && !cells.are_twins(cell, side, other, twin)) *numbers.asks_for_all = 1;
    if (other < cell) return;  // the edge is numbered elsewhere
    const std::int32_t before = cells.corner_before(cell, side);
    numbers.next_corners[twin] = before;
    numbers.edges[edge] = {before, side};
    numbers.side_edges[side] = numbers.side_edges[twin] = edge;
    if (is_elsewhere) numbers.edges_elsewhere.add(twin, edge);
    numbers.edge_sites[edge] = {cells.original[cell], cells.original[other]};
    ++edge;
  });
  numbers.for_sides(first, end, [&](std::int32_t side) {
    if (cells.is_open(side)) numbers.corner_vertices[side] = -1;
  });
  if (!fits) *numbers.misfits_here = 1;
}

/// Walks from a cell's corner to the same vertex's corner of the next cell about it, and so on.
struct CornerWalk {
  const DeviceCells& cells;
  const std::int32_t* next_corners;
  std::int32_t cell, corner;

  __device__ void step() {
    const std::int32_t next = cells.neighbor(corner);
    corner = cells.mine.holds(cell) ? next_corners[corner] : cells.corner_before(next, cells.twin_side(cell, corner));
    cell = next;
  }
};

/// The cell that a corner's vertex belongs to, the lowest about it, and its corner.
__device__ inline CornerWalk owner_of(const DeviceCells& cells, const std::int32_t* next_corners, std::int32_t cell,
                                      std::int32_t corner) {
  CornerWalk walk{cells, next_corners, cell, corner};
  std::int32_t lowest = cell, at = corner;
  for (walk.step(); walk.corner != corner; walk.step())
    if (walk.cell < lowest) lowest = walk.cell, at = walk.corner;
  return {cells, next_corners, lowest, at};
}

/// Calls found(corner) for the corners of the vertices that belong to a cell: no lower rank is about them.
template <class Found>
__device__ void for_own_vertices(const DeviceCells& cells, const DeviceNumbers& numbers, std::int32_t cell,
                                 Found&& found) {
  const std::int32_t first = cells.offsets[cell], last = cells.offsets[cell + 1] - 1;
  numbers.for_sides(first, last + 1, [&](std::int32_t corner) {
    const std::int32_t other = cells.neighbor(corner), third = cells.neighbor(corner == last ? first : corner + 1);
    if (min(other, third) < cell || cells.is_open(corner)) return;
    if (owner_of(cells, numbers.next_corners, cell, corner).cell == cell) found(corner);
  });
}

__global__ void count_vertices(DeviceCells cells, DeviceNumbers numbers, std::int32_t* counts) {
  const std::int32_t cell = cells.of_thread();
  if (cell >= cells.mine.end || numbers.failed_before()) return;
  std::int32_t mine = 0;
  for_own_vertices(cells, numbers, cell, [&](std::int32_t) { ++mine; });
  counts[cell] = mine;
}

__device__ inline Point2 weighted_vertex(const DeviceCells& cells, const std::int32_t about[3], std::int32_t vertex,
                                         const RoughVertices& rough) {
  const predicates::WeightedPoint2 here = cells.weighted(about[0]);
  const WaveCrossing crossing =
      wave_crossing(wave_of(here, cells.weighted(about[1])), wave_of(here, cells.weighted(about[2])));
  if (!crossing.is_good()) {
    const int place = atomicAdd(rough.count, 1);
    if (place < rough.room)
      rough.vertices[place] = {vertex, cells.original[about[0]], cells.original[about[1]], cells.original[about[2]]};
  }
  return crossing_point(here, crossing.x, crossing.y, crossing.height);
}

/// `vertices_before`: those numbered here, which may be corners of cells that are not.
template <bool HasOthers>
__global__ void __launch_bounds__(k_threads, 4)
    add_vertices(DeviceCells cells, const std::int32_t* vertices_before, DeviceNumbers numbers) {
  const std::int32_t cell = cells.of_thread();
  if (cell >= cells.mine.end || numbers.failed_before()) return;
  std::int32_t vertex = numbers.first_vertex + vertices_before[cell];
  for_own_vertices(cells, numbers, cell, [&](std::int32_t corner) {
    CornerWalk walk{cells, numbers.next_corners, cell, corner};
    std::int32_t about[3];
    int size = 0;
    bool is_told = false;
    do {
      numbers.corner_vertices[walk.corner] = vertex;
      if (HasOthers && !cells.mine.holds(walk.cell)) is_told = true;
      if (size < 3) about[size] = walk.cell;
      ++size;
      walk.step();
    } while (walk.corner != corner);
    if (is_told) {
      do {
        if (!cells.mine.holds(walk.cell)) numbers.vertices_elsewhere.add(walk.corner, vertex);
        walk.step();
      } while (walk.corner != corner);
    }
    for (int k = 0; size > 3 && k < size; ++k) {  // three of many, evenly about it
      walk.step();
      if (k == size - 1) about[0] = walk.cell;
      if (k == size / 3 - 1) about[1] = walk.cell;
      if (k == 2 * size / 3 - 1) about[2] = walk.cell;
    }
    const Point2 place = cells.weights
                             ? weighted_vertex(cells, about, vertex, numbers.rough)
                             : circumcenter_point(cells.point(about[0]), cells.point(about[1]), cells.point(about[2]));
    numbers.vertices[vertex++] = {place.x, place.y};
  });
}

__global__ void add_ends(IndexRange edges, DeviceNumbers numbers) {
  const std::int32_t edge = edges.begin + thread_number();
  if (edge >= edges.end || numbers.failed_before()) return;
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

/// A vertex about which d cells lie has d - 2 triangles.
__global__ void count_triangles(DeviceCells cells, DeviceNumbers numbers, std::int32_t* counts) {
  const std::int32_t cell = cells.of_thread();
  if (cell >= cells.mine.end || numbers.failed_before()) return;
  std::int32_t mine = 0;
  for_own_vertices(cells, numbers, cell, [&](std::int32_t corner) {
    CornerWalk walk{cells, numbers.next_corners, cell, corner};
    for (walk.step(); walk.corner != corner; walk.step()) ++mine;
    --mine;
  });
  counts[cell] = mine;
}

/// Adds triangles as Voronoi2d::delaunay does: vertex after vertex, fans from the site with the smallest index.
__global__ void add_triangles(DeviceCells cells, const std::int32_t* triangles_before, DeviceNumbers numbers,
                              std::int32_t* triangles) {
  const std::int32_t cell = cells.of_thread();
  if (cell >= cells.mine.end || numbers.failed_before()) return;
  std::int64_t at = 3 * static_cast<std::int64_t>(triangles_before[cell]);
  for_own_vertices(cells, numbers, cell, [&](std::int32_t corner) {
    CornerWalk walk{cells, numbers.next_corners, cell, corner};
    CornerWalk first = walk;
    for (walk.step(); walk.corner != corner; walk.step())
      if (cells.original[walk.cell] < cells.original[first.cell]) first.cell = walk.cell, first.corner = walk.corner;
    walk.cell = first.cell, walk.corner = first.corner;
    walk.step();
    std::int32_t before = cells.original[walk.cell];
    for (walk.step(); walk.corner != first.corner; walk.step()) {
      const std::int32_t next = cells.original[walk.cell];
      triangles[at++] = cells.original[first.cell];
      triangles[at++] = before;
      triangles[at++] = next;
      before = next;
    }
  });
}

/// Rows, then numbers, of a part of the cells. With one part nothing waits for the device; whether all fits is known at
/// the end.
class DeviceDiagram {
 public:
  /// Takes the memory for so many sides.
  DeviceDiagram(const PlanePart& part, std::int32_t cells, std::int32_t sides, bool has_weights, cudaStream_t stream)
      : part_(part),
        stream_(stream),
        count_(cells),
        cell_sides_(size(sides), stream),
        corner_vertices_(size(sides), stream),
        side_edges_(size(sides), stream),
        edge_vertices_(size(sides / 2), stream),
        edge_sites_(size(sides / 2), stream),
        vertex_places_(size(std::max(0, sides / 2 - cells + 1)), stream),
        next_corners_(size(sides), stream),
        counts_(size(cells) + 1, stream),
        before_(size(cells) + 1, stream),
        rough_(has_weights ? k_most_rough : 0, stream),
        misfits_(k_misfits, stream),
        rows_elsewhere_(part.is_all() ? 0 : sides / part.members(), stream),
        edges_elsewhere_(part.is_all() ? 0 : sides / part.members(), stream),
        vertices_elsewhere_(part.is_all() ? 0 : sides / part.members(), stream) {}

  /// Brings to the device what a member of a team calls, before there is other work for it.
  static void load(int members, bool only_triangles) {
    load_kernels(check_open_cells, expect_sum);
    if (members == 1) {
      load_kernels(gather_rows<false>, join_sides<false>);
    } else {
      load_kernels(gather_rows<true>, join_sides<true>);
    }
    if (only_triangles) {
      load_kernels(count_triangles, add_triangles);
    } else {
      load_kernels(count_vertices, members == 1 ? add_vertices<false> : add_vertices<true>, add_ends);
    }
  }

  /// Returns what no diagram has more of, by Euler's formula.
  static std::int32_t most_sides(std::int32_t cells) {
    return static_cast<std::int32_t>(
        std::min<std::int64_t>(6 * std::int64_t{cells}, std::numeric_limits<std::int32_t>::max()));
  }
  /// Returns how many there are; not more than there is memory for. \return whether that can be, by Euler's formula
  bool has(std::int32_t sides) {
    sides_ = sides;
    edges_ = sides / 2;
    vertices_ = edges_ - count_ + 1;
    return sides_ % 2 == 0 && vertices_ >= 0 && sides_ <= most_sides(count_);
  }
  const std::int32_t* cell_sides() const { return cell_sides_.data(); }
  DiagramSizes sizes() const { return {count_, edges_, vertices_}; }

  /// Stops all joining and numbering, so that the stream soon comes to its end.
  void stop(cudaStream_t aside) { (void)cudaMemsetAsync(misfits_.data() + k_before, 1, sizeof(int), aside); }

  /// Joins the cells. \throw LeftOver
  void join(const DeviceCells& cells, const DeviceBuffer<std::int32_t>& offsets, const DeviceLists& lists) {
    misfits_.fill_bytes(0);
    counts_.fill_bytes(0);
    const unsigned blocks = blocks_for(cells.mine.count());
    side_parts_ = part_.rows(offsets, sides_, stream_);
    if (part_.is_all()) {
      gather<false>(cells, lists);
    } else {
      rows_elsewhere_.fill([&] { gather<true>(cells, lists); });
      rows_elsewhere_.exchange(part_.arrays, part_.member, {0, sides_}, cell_sides_.data());
    }
    if (!cells.weights) {
      check_open_cells<<<blocks, k_threads, 0, stream_>>>(cells, lists.is_open, numbers().misfits_here);
      check_cuda(cudaGetLastError(), "joining cells");
    }
    edge_parts_ = numbered(edges_);
    if (part_.is_all()) {
      join_sides<false><<<blocks, k_threads, 0, stream_>>>(cells, before_.data(), numbers());
      check_cuda(cudaGetLastError(), "joining cells");
    } else {
      join_with_others(cells);
    }
    expect_sum<<<1, 1, 0, stream_>>>(misfits_.data() + k_here, 0, misfits_.data());
    check_cuda(cudaGetLastError(), "joining cells");
    if (part_.is_all()) return;
    // Several go on only where all fits with all: a walk about a vertex would not end otherwise.
    if (!fits()) throw LeftOver();
    edges_elsewhere_.exchange(part_.arrays, part_.member, part_.range(side_parts_), side_edges_.data());
  }

  /// Copies what is done as soon as it is. \throw LeftOver
  void number(const DeviceCells& cells, HostCopies& copies, const DiagramArrays& to) {
    const unsigned blocks = blocks_for(cells.mine.count());
    copy<1>(copies, side_edges_, part_.range(side_parts_), to.side_edges);
    count_vertices<<<blocks, k_threads, 0, stream_>>>(cells, numbers(), counts_.data());
    check_cuda(cudaGetLastError(), "counting vertices");
    vertex_parts_ = numbered(vertices_);
    if (part_.is_all()) {
      add_vertices<false><<<blocks, k_threads, 0, stream_>>>(cells, before_.data(), numbers());
      check_cuda(cudaGetLastError(), "placing vertices");
    } else {
      vertices_elsewhere_.fill([&] {
        check_cuda(cudaMemsetAsync(rough_vertices().count, 0, sizeof(int), stream_), "clearing a counter");
        add_vertices<true><<<blocks, k_threads, 0, stream_>>>(cells, before_.data(), numbers());
        check_cuda(cudaGetLastError(), "placing vertices");
      });
      vertices_elsewhere_.exchange(part_.arrays, part_.member, part_.range(side_parts_), corner_vertices_.data());
    }
    copy<2>(copies, vertex_places_, part_.range(vertex_parts_), to.vertices);
    copy<1>(copies, corner_vertices_, part_.range(side_parts_), to.corner_vertices);
    const IndexRange own = part_.range(edge_parts_);
    add_ends<<<blocks_for(own.count()), k_threads, 0, stream_>>>(own, numbers());
    check_cuda(cudaGetLastError(), "numbering edges");
    copy<2>(copies, edge_vertices_, own, to.edges);
    copy<2>(copies, edge_sites_, own, to.edge_sites);
  }

  /// The Delaunay triangles of joined cells; calls wait() for how many there are. \throw LeftOver
  template <class Wait>
  DeviceBuffer<std::int32_t> triangles(const DeviceCells& cells, Wait&& wait) {
    const unsigned blocks = blocks_for(cells.mine.count());
    count_triangles<<<blocks, k_threads, 0, stream_>>>(cells, numbers(), counts_.data());
    check_cuda(cudaGetLastError(), "counting triangles");
    add_up(counts_, before_, stream_);
    wait();
    if (!fits()) throw LeftOver();
    DeviceBuffer<std::int32_t> found(3 * size(before_.value_at(size(count_))), stream_);
    add_triangles<<<blocks, k_threads, 0, stream_>>>(cells, before_.data(), numbers(), found.data());
    check_cuda(cudaGetLastError(), "listing triangles");
    return found;
  }

  void hand_over(KeptPlane& to) {
    to.corner_vertices = std::move(corner_vertices_);
    to.side_edges = std::move(side_edges_);
    to.edges = std::move(edge_vertices_);
    to.edge_sites = std::move(edge_sites_);
    to.vertices = std::move(vertex_places_);
  }

  /// Vertices of this part that the processor places. Waits for the stream. \throw LeftOver for too many
  std::vector<int4> rough() const {
    const int count = rough_.size() == 0 ? 0 : misfits_.value_at(k_rough);
    if (count > k_most_rough) throw LeftOver();
    std::vector<int4> result(static_cast<std::size_t>(count));
    if (count > 0) rough_.read(result);
    return result;
  }

  /// Waits for the stream.
  bool fits() const { return misfits_.value_at(k_before) == 0; }

 private:
  static constexpr int k_most_rough = 1 << 16;
  enum { k_before, k_here, k_rough, k_asks_for_all, k_misfits };
  RoughVertices rough_vertices() { return {rough_.data(), misfits_.data() + k_rough, static_cast<int>(rough_.size())}; }
  static std::size_t size(std::int32_t count) { return static_cast<std::size_t>(count); }

  template <bool HasOthers>
  void gather(const DeviceCells& cells, const DeviceLists& lists) {
    gather_rows<HasOthers><<<blocks_for(cells.mine.count()), k_threads, 0, stream_>>>(
        lists, cells.mine, cells.offsets, cell_sides_.data(), counts_.data(), numbers(), rows_elsewhere_.list());
    check_cuda(cudaGetLastError(), "gathering cells");
  }

  /// Gets all rows of others where those of neighbors do not do.
  void join_with_others(const DeviceCells& cells) {
    const auto join = [&] {
      edges_elsewhere_.fill([&] {
        join_sides<true><<<blocks_for(cells.mine.count()), k_threads, 0, stream_>>>(cells, before_.data(), numbers());
        check_cuda(cudaGetLastError(), "joining cells");
      });
    };
    join();
    const auto asked = part_.arrays.numbers_of_all(part_.member, misfits_.value_at(k_asks_for_all));
    if (std::ranges::all_of(asked, [](std::int64_t each) { return each == 0; })) return;
    part_.arrays.share(part_.member, cell_sides_.data(), side_parts_, stream_);
    join();
  }

  DeviceNumbers numbers() {
    const auto first = [&](const std::vector<std::int32_t>& parts) {
      return parts.empty() ? 0 : part_.range(parts).begin;
    };
    return {next_corners_.data(),       corner_vertices_.data(),
            side_edges_.data(),         edge_vertices_.data(),
            edge_sites_.data(),         vertex_places_.data(),
            rough_vertices(),           misfits_.data(),
            misfits_.data() + k_here,   first(edge_parts_),
            first(vertex_parts_),       edges_elsewhere_.list(),
            vertices_elsewhere_.list(), misfits_.data() + k_asks_for_all};
  }
  /// Adds up what has been counted of each cell, which is to be `total` of all. \return where the members' numbers
  /// begin, and where the last's end. \throw LeftOver
  std::vector<std::int32_t> numbered(std::int32_t total) {
    if (part_.is_all()) {
      add_up(counts_, before_, stream_);
      expect_sum<<<1, 1, 0, stream_>>>(before_.data() + count_, total, misfits_.data());
      check_cuda(cudaGetLastError(), "counting");
      return {0, total};
    }
    std::vector<std::int32_t> parts = part_.add_up_own(counts_, before_, stream_);
    if (parts.back() != total) throw LeftOver();
    return parts;
  }
  template <int Width, class Number, class To>
  static void copy(HostCopies& copies, const DeviceBuffer<Number>& from, IndexRange part, To* to) {
    copies.to_host(from.data() + part.begin, size(part.count()),
                   to ? to + Width * static_cast<std::size_t>(part.begin) : to);
  }

  const PlanePart& part_;
  cudaStream_t stream_;
  std::int32_t count_, sides_ = 0, edges_ = 0, vertices_ = 0;
  DeviceBuffer<std::int32_t> cell_sides_, corner_vertices_, side_edges_;
  DeviceBuffer<int2> edge_vertices_, edge_sites_;
  DeviceBuffer<double2> vertex_places_;
  DeviceBuffer<std::int32_t> next_corners_, counts_, before_;
  DeviceBuffer<int4> rough_;
  DeviceBuffer<int> misfits_;  ///< before and here, how many vertices are rough, and whether rows are missing
  NumbersElsewhere rows_elsewhere_, edges_elsewhere_, vertices_elsewhere_;
  std::vector<std::int32_t> side_parts_, edge_parts_, vertex_parts_;  ///< where the members' begin
};

}  // namespace
}  // namespace saddleback::voronoi2d
