#pragma once
// The tables that windows run on, laid on the device from the mesh as the host has it: the CUDA counterpart of
// NodeEdges, WindowMesh and WaveSectors. Laying them on the processor took as long as all the rest of a graph's
// construction, and copying them twice as long as copying the mesh.

#include <math_constants.h>

#include "geodesics/cuda/device_window_memory.cuh"
#include "geodesics/graph/arcs_abi.h"
#include "geodesics/unfolding/unfolded_corner.h"
#include "support/cuda/device_buffer.h"
#include "support/cuda/device_launch.cuh"
#include "support/cuda/device_scratch.cuh"
#include "support/cuda/host_copies.h"

namespace saddleback {
namespace {

/// A mesh in device memory, as ArcsRequest has it.
struct RawMesh {
  const std::int32_t *triangles, *twins;  ///< per half-edge
  const double *lengths, *areas, *polars;
  const std::int32_t* first_halfedges;  ///< per vertex
  const double* total_angles;
  const std::uint8_t* saddles;
  const std::int32_t *nodes, *vertices;
  double unit, sectors;

  __device__ static std::int32_t next(std::int32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  __device__ static std::int32_t prev(std::int32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  __device__ std::int32_t from(std::int32_t h) const { return triangles[h]; }
  __device__ std::int32_t to(std::int32_t h) const { return triangles[next(h)]; }
  __device__ std::int32_t apex(std::int32_t h) const { return triangles[prev(h)]; }
  __device__ double per_radian(std::int32_t vertex) const { return sectors / total_angles[vertex]; }
  /// Calls use(half-edge) for those out of a node, counter-clockwise.
  template <class Use>
  __device__ void each_out_of(std::int32_t node, Use&& use) const {
    const std::int32_t start = first_halfedges[vertices[node]];
    std::int32_t h = start;
    do {
      use(h);
      h = twins[prev(h)];
    } while (h >= 0 && h != start);
  }
};

/// DeviceMesh while it is made, and what is needed for it.
struct MeshInMaking {
  EdgeRecord* records;
  std::int32_t *first, *targets;
  double* lengths;
  float *sectors, *reverse_sectors, *apex_sectors, *per_radian;
  std::uint8_t* saddles;
  std::int32_t *halfedges, *edge_of;  ///< as in NodeEdges
  double2* about;                     ///< per node: from there to the edges opposite it, at least; the shortest edge
  float* clearances;                  ///< per edge
};

/// The last count is 0, so that sums before each have the sum of all at the end.
__global__ void count_edges(RawMesh raw, std::int32_t nodes, std::int32_t* counts) {
  const std::int32_t node = thread_number();
  if (node > nodes) return;
  std::int32_t count = 0;
  if (node < nodes) raw.each_out_of(node, [&](std::int32_t) { ++count; });
  counts[node] = count;
}

__global__ void list_edges(RawMesh raw, std::int32_t nodes, MeshInMaking mesh) {
  const std::int32_t node = thread_number();
  if (node >= nodes) return;
  std::int32_t edge = mesh.first[node];
  raw.each_out_of(node, [&](std::int32_t h) {
    mesh.halfedges[edge] = h;
    mesh.edge_of[h] = edge++;
  });
  const std::int32_t vertex = raw.vertices[node];
  mesh.saddles[node] = raw.saddles[vertex];
  mesh.per_radian[node] = static_cast<float>(raw.per_radian(vertex));
}

__global__ void lay_edges(RawMesh raw, std::int32_t edges, MeshInMaking mesh) {
  const std::int32_t e = thread_number();
  if (e >= edges) return;
  const std::int32_t h = mesh.halfedges[e], after = RawMesh::next(h), before = RawMesh::prev(h);
  const auto edge_behind = [&](std::int32_t side) { return raw.twins[side] < 0 ? -1 : mesh.edge_of[raw.twins[side]]; };
  const std::int32_t from = raw.from(h), to = raw.to(h), apex = raw.apex(h);
  const double base = raw.lengths[h];
  mesh.records[e] = {corner_along(base, raw.lengths[before], raw.lengths[after]) / base,
                     corner_off(base, raw.areas[h / 3]) / base,
                     edge_behind(before),
                     edge_behind(after),
                     raw.nodes[apex],
                     0};
  mesh.targets[e] = raw.nodes[to];
  mesh.lengths[e] = base / raw.unit;
  const double back = raw.twins[h] < 0 ? raw.total_angles[to] : raw.polars[raw.twins[h]];
  mesh.sectors[e] = static_cast<float>(raw.polars[h] * raw.per_radian(from));
  mesh.reverse_sectors[e] = static_cast<float>(back * raw.per_radian(to));
  mesh.apex_sectors[e] = static_cast<float>(raw.polars[before] * raw.per_radian(apex));
}

// As in WindowMesh::find_clearances.

__device__ inline double dot(double2 a, double2 b) { return a.x * b.x + a.y * b.y; }
__device__ inline double2 minus(double2 a, double2 b) { return {a.x - b.x, a.y - b.y}; }
__device__ inline double distance_to_segment(double2 point, double2 from, double2 to) {
  const double2 along = minus(to, from);
  const double squared = dot(along, along);
  const double part = squared > 0 ? fmin(fmax(dot(minus(point, from), along) / squared, 0.0), 1.0) : 0;
  return norm_of(from.x + part * along.x - point.x, from.y + part * along.y - point.y);
}

__device__ inline double2 corner_of(const MeshInMaking& mesh, std::int32_t e) {
  const EdgeRecord& record = mesh.records[e];
  return {record.a * mesh.lengths[e], record.b * mesh.lengths[e]};
}

__global__ void look_about(std::int32_t nodes, MeshInMaking mesh) {
  const std::int32_t node = thread_number();
  if (node >= nodes) return;
  double clearance = CUDART_INF, shortest = CUDART_INF;
  for (std::int32_t e = mesh.first[node]; e < mesh.first[node + 1]; ++e) {
    const double2 target{mesh.lengths[e], 0}, far = corner_of(mesh, e);
    clearance = fmin(clearance, distance_to_segment({0, 0}, target, far));
    shortest = fmin(shortest, fmin(target.x, norm_of(far.x, far.y)));
  }
  mesh.about[node] = {clearance, shortest};
}

__global__ void find_clearances(RawMesh raw, std::int32_t edges, MeshInMaking mesh) {
  const std::int32_t e = thread_number();
  if (e >= edges) return;
  const double2 target{mesh.lengths[e], 0}, far = corner_of(mesh, e);
  const auto beside = [](double2 about, double2 along, double2 to_apex) {
    const double cross = along.x * to_apex.y - along.y * to_apex.x;
    const double sine =
        dot(along, to_apex) > 0 ? fabs(cross) / (norm_of(along.x, along.y) * norm_of(to_apex.x, to_apex.y)) : 1;
    return fmin(about.x, sine * about.y);
  };
  const double least = fmin(distance_to_segment(far, {0, 0}, target),
                            fmin(beside(mesh.about[raw.nodes[raw.from(mesh.halfedges[e])]], target, far),
                                 beside(mesh.about[mesh.targets[e]], {-target.x, 0}, minus(far, target))));
  mesh.clearances[e] = static_cast<float>(least * (1 - k_clearance_rounding));
}

/// Sees to it as well that who looks a record up need not look up whether its apex is a saddle.
__global__ void note_clearances(std::int32_t edges, MeshInMaking mesh) {
  const std::int32_t e = thread_number();
  if (e >= edges) return;
  EdgeRecord& record = mesh.records[e];
  const auto upper_half = [&](std::int32_t edge) {
    return edge < 0 ? 0U : static_cast<std::uint32_t>(__float_as_int(mesh.clearances[edge])) >> 16;
  };
  record.clearances = upper_half(record.left) << 16 | (upper_half(record.right) & ~k_saddle_bit) |
                      (mesh.saddles[record.apex] != 0 ? k_saddle_bit : 0);
}

/// The vertices at the other ends of the mesh edges about each node. At the boundary the last edge's face has a side
/// that is no edge of the node's. `more` counts the blocks behind those of the nodes.
__global__ void list_neighbors(DeviceMesh mesh, std::int32_t nodes, Neighbor* neighbors, std::int32_t* more) {
  const std::int32_t node = thread_number();
  if (node >= nodes) return;
  const std::int32_t begin = mesh.first[node], end = mesh.first[node + 1];
  const bool has_other_side = end > begin && mesh.records[end - 1].left < 0;
  std::int32_t block = node, filled = 0, left = end - begin + (has_other_side ? 1 : 0);
  const auto add = [&](std::int32_t target, double length) {
    if (filled == Neighbor::k_block - 1 && left > 1) {
      const std::int32_t next = nodes + atomicAdd(more, 1);
      neighbors[block * Neighbor::k_block + filled] = {Neighbor::k_link | static_cast<std::uint32_t>(next), 0};
      block = next;
      filled = 0;
    }
    const std::uint32_t key = DiskKey<1>::pack(target, 0, mesh.saddles[target] != 0);
    neighbors[block * Neighbor::k_block + filled++] = {key, static_cast<float>(length)};
    --left;
  };
  for (std::int32_t e = begin; e < end; ++e) add(mesh.targets[e], mesh.lengths[e]);
  if (has_other_side) {
    const EdgeRecord& last = mesh.records[end - 1];
    const double length = mesh.lengths[end - 1];
    add(last.apex, norm_of(last.a * length, last.b * length));
  }
  for (; filled < Neighbor::k_block; ++filled) neighbors[block * Neighbor::k_block + filled] = {Neighbor::k_none, 0};
}

/// Owns what DeviceMesh shows.
class MeshTables {
 public:
  /// Calls choose_packing() while the mesh is copied.
  template <class ChoosePacking>
  MeshTables(const ArcsRequest& r, cudaStream_t stream, ChoosePacking&& choose_packing)
      : stream_(stream),
        nodes_(r.node_count),
        edges_(r.edge_count),
        records_(per_edge(), stream),
        first_(per_node() + 1, stream),
        targets_(per_edge(), stream),
        lengths_(per_edge(), stream),
        sectors_(per_edge(), stream),
        reverse_sectors_(per_edge(), stream),
        apex_sectors_(per_edge(), stream),
        per_radian_(per_node(), stream),
        saddles_(per_node(), stream),
        neighbors_(r.k > 0 ? Neighbor::k_block * neighbor_blocks(r) : 0, stream),
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
              {},
              r.k,
              r.detour,
              r.per_detour,
              r.excess,
              r.slack,
              neighbors_.data()} {
    lay(r, choose_packing);
    if (r.k > 0) {
      DeviceBuffer<std::int32_t> more(1, stream);
      more.fill_bytes(0);
      list_neighbors<<<blocks_for(nodes_), k_threads, 0, stream>>>(mesh_, nodes_, neighbors_.data(), more.data());
      check_cuda(cudaGetLastError(), "listing neighbors");
    }
  }
  const DeviceMesh& mesh() const { return mesh_; }

  /// Bytes, while the tables are laid.
  static std::uint64_t bytes_needed(const ArcsRequest& r) {
    constexpr std::uint64_t k_raw_edge = 2 * 4 + 2 * 8 + 3, k_raw_node = 8 + 3 * 4 + 1, k_in_making = 3 * 4;
    const auto nodes = static_cast<std::uint64_t>(r.node_count), edges = static_cast<std::uint64_t>(r.edge_count);
    const std::uint64_t neighbors = r.k > 0 ? sizeof(Neighbor) * Neighbor::k_block * neighbor_blocks(r) : 0;
    return edges * (sizeof(EdgeRecord) + 24 + k_raw_edge + k_in_making) + nodes * (9 + k_raw_node + sizeof(double2)) +
           neighbors;
  }

 private:
  std::size_t per_edge() const { return static_cast<std::size_t>(edges_); }
  std::size_t per_node() const { return static_cast<std::size_t>(nodes_); }
  /// Bounds the blocks: all but the last of a node's blocks hold seven, and it has one more neighbor than edges.
  static std::size_t neighbor_blocks(const ArcsRequest& r) {
    const auto nodes = static_cast<std::size_t>(r.node_count);
    return nodes + (static_cast<std::size_t>(r.edge_count) + nodes) / 7;
  }

  template <class ChoosePacking>
  void lay(const ArcsRequest& r, ChoosePacking&& choose_packing) {
    DeviceBuffer<std::int32_t> triangles(per_edge(), stream_), twins(per_edge(), stream_);
    DeviceBuffer<double> lengths(per_edge(), stream_), areas(per_edge() / 3, stream_), polars(per_edge(), stream_);
    DeviceBuffer<std::int32_t> first_halfedges(per_node(), stream_), nodes(per_node(), stream_);
    DeviceBuffer<std::int32_t> vertices(per_node(), stream_);
    DeviceBuffer<double> total_angles(per_node(), stream_);
    DeviceBuffer<std::uint8_t> saddles(per_node(), stream_);
    HostCopies copies(stream_);
    const auto fill = [&](const auto* from, auto& to) { copies.to_device(from, to.size(), to.data()); };
    fill(r.triangles, triangles);
    fill(r.twins, twins);
    fill(r.first_halfedges, first_halfedges);
    fill(r.lengths, lengths);
    fill(r.face_areas, areas);
    fill(r.polars, polars);
    fill(r.total_angles, total_angles);
    fill(r.saddles, saddles);
    fill(r.nodes, nodes);
    fill(r.vertices, vertices);
    mesh_.packing = choose_packing();
    copies.finish();
    lay({triangles.data(), twins.data(), lengths.data(), areas.data(), polars.data(), first_halfedges.data(),
         total_angles.data(), saddles.data(), nodes.data(), vertices.data(), r.unit,
         static_cast<double>(r.sector_count)});
  }

  void lay(const RawMesh& raw) {
    DeviceBuffer<std::int32_t> counts(per_node() + 1, stream_), halfedges(per_edge(), stream_);
    DeviceBuffer<std::int32_t> edge_of(per_edge(), stream_);
    DeviceBuffer<double2> about(per_node(), stream_);
    DeviceBuffer<float> clearances(per_edge(), stream_);
    const MeshInMaking mesh{records_.data(),  first_.data(),           targets_.data(),      lengths_.data(),
                            sectors_.data(),  reverse_sectors_.data(), apex_sectors_.data(), per_radian_.data(),
                            saddles_.data(),  halfedges.data(),        edge_of.data(),       about.data(),
                            clearances.data()};
    count_edges<<<blocks_for(nodes_ + 1), k_threads, 0, stream_>>>(raw, nodes_, counts.data());
    add_up(counts, first_, stream_);
    list_edges<<<blocks_for(nodes_), k_threads, 0, stream_>>>(raw, nodes_, mesh);
    lay_edges<<<blocks_for(edges_), k_threads, 0, stream_>>>(raw, edges_, mesh);
    look_about<<<blocks_for(nodes_), k_threads, 0, stream_>>>(nodes_, mesh);
    find_clearances<<<blocks_for(edges_), k_threads, 0, stream_>>>(raw, edges_, mesh);
    note_clearances<<<blocks_for(edges_), k_threads, 0, stream_>>>(edges_, mesh);
    check_cuda(cudaGetLastError(), "laying tables");
  }

  cudaStream_t stream_;
  std::int32_t nodes_, edges_;
  DeviceBuffer<EdgeRecord> records_;
  DeviceBuffer<std::int32_t> first_, targets_;
  DeviceBuffer<double> lengths_;
  DeviceBuffer<float> sectors_, reverse_sectors_, apex_sectors_, per_radian_;
  DeviceBuffer<std::uint8_t> saddles_;
  DeviceBuffer<Neighbor> neighbors_;
  DeviceMesh mesh_;
};

}  // namespace
}  // namespace saddleback
