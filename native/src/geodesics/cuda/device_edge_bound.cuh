#pragma once
// The radius of a disk whose source sees too few vertices, by the edges of the mesh: the CUDA counterpart of
// GeodesicDisks::radius_by_edges.

#include <cstdint>

#include "geodesics/cuda/device_disk.cuh"

namespace saddleback {
namespace {

/// Holds what is kept for it, in global memory: it is seldom asked for.
template <int Slots>
struct alignas(16) EdgeDistances {
  std::int32_t known[Slots];  ///< bits of the distances by edges
  std::int32_t told[Slots];   ///< of those that the neighbors were told of
};

/// Dijkstra's front, a mean edge at a time: what lies beyond the radius is not looked at, so that few vertices come
/// into the table that would not be there otherwise.
template <class Table>
class EdgeFront {
  static constexpr int k_slots = Table::Slots;

 public:
  SADDLEBACK_STEP EdgeFront(const DeviceMesh& mesh, Table& table, EdgeDistances<k_slots>& distances)
      : wanted_(mesh.k + 1), table_(table), distances_(distances), disk_(mesh, table), lane_(threadIdx.x & 31) {}

  /// Returns the radius; negative when the table has too little room.
  SADDLEBACK_STEP float radius() {
    for (int i = lane_; i < k_slots; i += 32) {
      distances_.known[i] = table_.labels[i];
      distances_.told[i] = k_unreached_label;
    }
    __syncwarp();
    while (true) {
      limit_ = nth_label<k_slots>(distances_.known, wanted_, limit_);
      const int count = list_nearest();
      if (count == 0) break;
      disk_.tell_neighbors(count, Tell{distances_});
      if (disk_.overflowed_anywhere()) return -1;
    }
    constexpr float k_no_end = 3.40282347e38f;  // there are not so many vertices
    return limit_ < k_unreached_label ? distance_of(limit_) * k_disk_as_far : k_no_end;
  }

 private:
  struct Tell {
    EdgeDistances<k_slots>& distances;
    SADDLEBACK_STEP float from(int slot) const { return distance_of(distances.told[slot]); }
    SADDLEBACK_STEP static std::int32_t label(float from, float length) { return __float_as_int(from + length); }
    SADDLEBACK_STEP static bool serves(std::int32_t) { return true; }
    SADDLEBACK_STEP void offer(WarpDisk<Table, 1>&, bool is_told, int slot, std::int32_t label) const {
      if (is_told) atomicMin(&distances.known[slot], label);
    }
  };

  SADDLEBACK_STEP bool is_open(int slot) const {
    const std::int32_t known = distances_.known[slot];
    return known < distances_.told[slot] && known < limit_;
  }

  /// Lists those of the open vertices that lie less than an edge beyond the nearest. \return how many
  SADDLEBACK_STEP int list_nearest() {
    __syncwarp();
    std::int32_t least = k_unreached_label;
    for (int i = lane_; i < k_slots; i += 32)
      if (is_open(i)) least = min(least, distances_.known[i]);
    least = static_cast<std::int32_t>(warp_min(static_cast<unsigned>(least)));
    if (least == k_unreached_label) return 0;
    const std::int32_t most = __float_as_int(distance_of(least) + 1);
    int count = 0;
    for (int base = 0; base < k_slots && count + 32 <= Table::Todo; base += 32) {
      const int slot = base + lane_;
      const bool tells = is_open(slot) && distances_.known[slot] <= most;
      const unsigned lanes = __ballot_sync(k_warp, tells);
      if (tells) {
        table_.todo[count + __popc(lanes & ((1u << lane_) - 1))] = static_cast<std::uint16_t>(slot);
        distances_.told[slot] = distances_.known[slot];
      }
      count += __popc(lanes);
    }
    __syncwarp();
    return count;
  }

  int wanted_;
  Table& table_;
  EdgeDistances<k_slots>& distances_;
  WarpDisk<Table, 1> disk_;
  int lane_;
  std::int32_t limit_ = k_unreached_label;
};

/// The k-th distance by mesh edges from the vertices with labels, and from above; the largest number where there are
/// not so many vertices, negative when the table has too little room for them. Not in line: what is seldom run had
/// better not be in the way of what often is.
template <class Table>
__device__ __noinline__ float radius_by_edges(const Neighbor* neighbors, std::int32_t k, Table* table,
                                              EdgeDistances<Table::Slots>* distances) {
  DeviceMesh mesh{};
  mesh.neighbors = neighbors;
  mesh.k = k;
  return EdgeFront<Table>(mesh, *table, *distances).radius();
}

}  // namespace
}  // namespace saddleback
