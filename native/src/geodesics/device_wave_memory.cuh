#pragma once
// What the windows of a warp's sources are kept in.
//
// What a source sees of the mesh is in a hash table, since it reaches a hundred vertices or two of all there are; a
// *slot* is an entry of that table.

#include <cstdint>
#include <type_traits>

#include "geodesics/arc_twin.h"
#include "geodesics/device_lane.cuh"

namespace saddleback {
namespace {

constexpr std::uint32_t k_no_key = 0xffffffffu;
constexpr std::int32_t k_unreached_label = 0x7f800000;

/// What is known of a node by its entry of the table: whose it is among the sources, and whether it is a saddle.
template <int Seats>
struct DiskKey {
  static constexpr std::uint32_t k_saddle = 1u << 30, k_node = k_saddle - 1;
  SADDLEBACK_STEP static std::uint32_t pack(std::int32_t node, int seat, bool is_saddle) {
    return static_cast<std::uint32_t>(node) * Seats + static_cast<std::uint32_t>(seat) | (is_saddle ? k_saddle : 0);
  }
  SADDLEBACK_STEP static std::int32_t node(std::uint32_t key) {
    return static_cast<std::int32_t>((key & k_node) / Seats);
  }
  SADDLEBACK_STEP static bool is_saddle(std::uint32_t key) { return (key & k_saddle) != 0; }
};

/// A vertex at the other end of a mesh edge, and the edge's length. A node has a block of eight; where it has more
/// neighbours the last of the block tells where the next block is.
struct alignas(8) Neighbour {
  static constexpr int k_block = 8;
  static constexpr std::uint32_t k_none = 0xffffffffu, k_link = 1u << 31;
  std::uint32_t key;  ///< DiskKey, k_none, or k_link and a block
  float length;
};

/// The mesh in device memory.
struct DeviceMesh {
  const EdgeRecord* records;
  const std::int32_t *first, *targets;
  const double* lengths;
  const float *sectors, *reverse_sectors, *apex_sectors, *per_radian;
  const std::uint8_t* saddles;
  double unit;
  ArcPacking packing;
  std::int32_t k;
  float detour, excess;
  double slack;
  const Neighbour* neighbours;  ///< blocks, those of the nodes first; where disks end by count
};

/// A half-edge of a source, among those of all sources of the warp.
struct RootEdge {
  static constexpr int k_most_edges = 1 << 15;  ///< of a source
  static constexpr int k_bits = 16;
  SADDLEBACK_STEP static int pack(int seat, int edge) { return seat << 15 | edge; }
  SADDLEBACK_STEP static int seat(int root) { return root >> 15 & 1; }
  SADDLEBACK_STEP static int edge(int root) { return root & (k_most_edges - 1); }
};

/// A vertex seen, until it is known whether an arc to it stays: the directions are computed only then.
struct alignas(16) Sighting {
  double2 place;      ///< of the vertex
  double2 from;       ///< start of the half-edge that the window came through
  std::int32_t edge;  ///< of the window; of a source's link, whether it is the other side of its face
  std::int32_t root;  ///< RootEdge; of a link, its complement
  std::int32_t slot;
  std::int32_t label;
};

/// What belongs to a window, by its indices.
struct alignas(16) WindowLinks {
  std::int32_t edge;   ///< its record
  std::uint32_t ends;  ///< slots of the half-edge's ends, see EndSlots
  std::uint32_t root;  ///< RootEdge; above it the slot of the apex, once it is sighted
  float most;          ///< radius beyond which the window serves nothing; where disks end by count, the disk's
};

/// Two slots in one word, left below right.
struct EndSlots {
  SADDLEBACK_STEP static std::uint32_t pack(int left, int right) {
    return static_cast<std::uint32_t>(left) | static_cast<std::uint32_t>(right) << 16;
  }
  SADDLEBACK_STEP static int slot(std::uint32_t ends, int side) { return static_cast<int>(ends >> 16 * side & 0xffff); }
  /// With another one on a side.
  SADDLEBACK_STEP static std::uint32_t replaced(std::uint32_t ends, int side, int slot) {
    return (ends & 0xffff0000u >> 16 * side) | static_cast<std::uint32_t>(slot) << 16 * side;
  }
};

/// A ray of a window and the vertex that it runs through, where its distance and the way to it are asked for.
template <bool All>
struct alignas(All ? 8 : 16) WindowRay;
template <>
struct alignas(8) WindowRay<true> {
  float x, y;
};
template <>
struct alignas(16) WindowRay<false> {
  float x, y, reach, way;
};

/// A side of a window's face that light falls on: the window's place, whether it is the right side, and whether the
/// window has no more.
struct Light {
  static constexpr int k_right = 1 << 14, k_last = 1 << 15, k_place = k_right - 1;
};

/// A warp's windows. Each has a place. *Left* is 0 and *right* is 1 of what there is two of. Less for each leaves room
/// for more warps: what of a window is soon computed again is not kept.
template <bool All_, int Windows_>
struct alignas(16) WindowPool {
  static constexpr bool All = All_;
  static constexpr int Windows = Windows_;
  static constexpr int Lights = All ? Windows + Windows / 4 : Windows + 3 * Windows / 8;
  static_assert(Windows <= Light::k_place && Windows % 8 == 0);
  using Place = std::conditional_t<(Windows <= 256), std::uint8_t, std::uint16_t>;
  double2 ends[2][Windows];  ///< of the half-edge: start, which is on the left, and end
  WindowLinks links[Windows];
  WindowRay<All> rays[2][Windows];
  float ways[All ? 1 : Windows];  ///< to the apexes, once they are sighted
  std::uint16_t lights[Lights];
  Place order[Windows];  ///< of a generation: windows behind left sides, and from the end on those behind right ones
  Place free[Windows];   ///< places without windows
};

/// The vertices that the sources reached.
template <bool All_, int Slots_>
struct alignas(16) WaveTable {
  static constexpr bool All = All_;
  static constexpr int Slots = Slots_, Todo = 96, Draft = Slots + Slots / 2;  ///< sightings that make arcs
  static_assert(Slots % 128 == 0);
  std::int32_t labels[Slots];
  std::uint32_t keys[Slots];                    ///< nodes, and whose they are
  std::uint32_t changed[All ? Slots / 32 : 1];  ///< bits: neighbours may have to be told of the label
  std::uint16_t todo[All ? Todo : 1];
};

SADDLEBACK_STEP float distance_of(std::int32_t label) { return __int_as_float(label); }
SADDLEBACK_STEP std::int32_t label_of(float distance, bool makes_arc) {
  const std::int32_t bits = __float_as_int(distance) & ~1;
  return makes_arc ? bits : bits | 1;
}
/// As Eigen's norm.
SADDLEBACK_STEP double norm_of(double x, double y) { return __dsqrt_rn(x * x + y * y); }

}  // namespace
}  // namespace saddleback
