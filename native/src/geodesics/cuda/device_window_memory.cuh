#pragma once
// The memory of the windows of a warp's sources.
//
// What a source sees of the mesh is in a hash table, since it reaches a hundred vertices or two of all there are; a
// *slot* is an entry of that table.

#include <cstdint>
#include <type_traits>

#include "geodesics/cuda/device_lane.cuh"
#include "geodesics/cuda/device_sighting_order.cuh"
#include "geodesics/graph/arcs_abi.h"

namespace saddleback {
namespace {

constexpr std::uint32_t k_no_key = 0xffffffffu;       ///< in entries that are free
constexpr std::uint32_t k_never_a_key = 0x80000000u;  ///< in no entry: to put something in its place changes nothing
constexpr std::int32_t k_unreached_label = 0x7f800000;

/// Holds what is known of a node by its entry of the table: whose it is among the sources, and whether it is a saddle.
template <int Seats>
struct DiskKey {
  static constexpr std::uint32_t k_saddle = 1u << 30, k_node = k_saddle - 1;
  SADDLEBACK_STEP static std::uint32_t pack(std::int32_t node, int seat, bool is_saddle) {
    return static_cast<std::uint32_t>(node) * Seats + static_cast<std::uint32_t>(seat) | (is_saddle ? k_saddle : 0);
  }
  SADDLEBACK_STEP static std::int32_t node(std::uint32_t key) {
    return static_cast<std::int32_t>((key & k_node) / Seats);
  }
  SADDLEBACK_STEP static int seat(std::uint32_t key) { return static_cast<int>((key & k_node) % Seats); }
  SADDLEBACK_STEP static bool is_saddle(std::uint32_t key) { return (key & k_saddle) != 0; }
};

/// A vertex at the other end of a mesh edge, and the edge's length. A node has a block of eight; where it has more
/// neighbors the last of the block tells where the next block is.
struct alignas(8) Neighbor {
  static constexpr int k_block = 8;
  static constexpr std::uint32_t k_none = 0xffffffffu, k_link = 1u << 31;
  std::uint32_t key;  ///< DiskKey, k_none, or k_link and a block
  float length;

  SADDLEBACK_STEP bool is_node() const { return (key & k_link) == 0; }
  SADDLEBACK_STEP bool goes_on() const { return !is_node() & (key != k_none); }
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
  float detour, per_detour, excess;  ///< as of a WaveScene
  double slack;
  const Neighbor* neighbors;  ///< blocks, those of the nodes first; where disks end by count
};

/// A half-edge of a source, among those of all sources of the warp.
struct RootEdge {
  static constexpr int k_most_edges = 1 << k_root_edge_bits;  ///< of a source
  static constexpr int k_bits = 16;
  SADDLEBACK_STEP static int pack(int seat, int edge) { return seat << 15 | edge; }
  SADDLEBACK_STEP static int seat(int root) { return root >> 15 & 1; }
  SADDLEBACK_STEP static int edge(int root) { return root & (k_most_edges - 1); }
};

/// A vertex seen, until it is known whether an arc to it stays: the directions are computed only then.
struct alignas(16) Sighting {
  double2 place;        ///< of the vertex
  double2 from;         ///< start of the half-edge that the window came through
  std::int32_t edge;    ///< of the window; of a source's link, whether it is the other side of its face
  std::uint32_t turns;  ///< of the window, see device_sighting_order.cuh
  std::uint32_t ids;    ///< RootEdge; above it the SightedAt
  std::int32_t label;

  static constexpr std::int32_t k_begins = 1 << 31;  ///< in the label, of the first of a generation or of several
  SADDLEBACK_STEP static std::uint32_t pack(int root, int place) {
    return static_cast<std::uint32_t>(root) | static_cast<std::uint32_t>(place) << RootEdge::k_bits;
  }
  SADDLEBACK_STEP int root() const { return static_cast<int>(ids & ((1u << RootEdge::k_bits) - 1)); }
  SADDLEBACK_STEP int seen_at() const { return static_cast<int>(ids >> RootEdge::k_bits); }
};

/// The slot of what is seen; in tables of few slots, above it, how many turns its window has come through, and one:
/// what tells generations apart that are not marked by k_begins.
template <bool CountsGenerations>
struct SightedAt {
  static constexpr int k_bits = 16, k_slot_bits = CountsGenerations ? 10 : k_bits;
  SADDLEBACK_STEP static int pack(int slot, int generation) { return slot | generation << k_slot_bits; }
  SADDLEBACK_STEP static int slot(int place) { return place & ((1 << k_slot_bits) - 1); }
  SADDLEBACK_STEP static int generation(int place) { return place >> k_slot_bits; }
};

/// Holds what belongs to a window, by its indices: its half-edge's record, the slots of the half-edge's ends and, once
/// it is sighted, of the apex, the RootEdge and the turns.
struct alignas(16) WindowLinks {
  static constexpr int k_most_edges = RootEdge::k_most_edges;  ///< of a source
  std::int32_t edge;
  std::uint32_t ends;      ///< slots: left, above it right
  std::uint32_t root_ids;  ///< root, above it the apex
  std::uint32_t turned;

  SADDLEBACK_STEP static WindowLinks first(std::int32_t edge, int left, int right, int root) {
    return {edge, static_cast<std::uint32_t>(left) | static_cast<std::uint32_t>(right) << 16,
            static_cast<std::uint32_t>(root), 0};
  }
  SADDLEBACK_STEP int end(int side) const { return static_cast<int>(ends >> 16 * side & 0xffff); }
  SADDLEBACK_STEP int apex() const { return static_cast<int>(root_ids >> 16); }
  SADDLEBACK_STEP int root() const { return static_cast<int>(root_ids & 0xffff); }
  SADDLEBACK_STEP std::uint32_t turns() const { return turned; }
  /// Notes it in the window that it is a copy of.
  SADDLEBACK_STEP void note_apex(WindowLinks& there, int slot) const {
    there.root_ids = root_ids | static_cast<std::uint32_t>(slot) << 16;
  }
  SADDLEBACK_STEP void set_turns(std::uint32_t number, int) { turned = number; }
  /// Returns the links of the window behind a side, whose turns have `bits` before that.
  SADDLEBACK_STEP WindowLinks child(std::int32_t behind, int side, int bits) const {
    return {behind, (ends & 0xffffu << 16 * side) | (root_ids >> 16) << 16 * (1 - side), root_ids & 0xffff,
            turned | static_cast<std::uint32_t>(side) << bits};
  }
};

/// Holds the same in less, with the radius beyond which the window serves nothing. Turns have as many bits as there
/// were generations.
struct alignas(16) DenseLinks {
  static constexpr int k_slot_bits = 10, k_edge_bits = 7, k_generation_bits = 5;
  static constexpr int k_seat = k_edge_bits, k_generation = k_seat + 1, k_turns = k_generation + k_generation_bits;
  static constexpr int k_most_edges = 1 << k_edge_bits;  ///< of a source
  static constexpr std::uint32_t k_slot = (1u << k_slot_bits) - 1;
  static_assert(k_turns + k_most_turns <= 32 && k_most_turns < 1 << k_generation_bits);
  std::int32_t edge;
  std::uint32_t slots;   ///< left, right, apex, from the lowest bits on
  std::uint32_t origin;  ///< half-edge of the source, seat, generation, turns
  float most;

  SADDLEBACK_STEP static DenseLinks first(std::int32_t edge, int left, int right, int root) {
    return {edge, static_cast<std::uint32_t>(left) | static_cast<std::uint32_t>(right) << k_slot_bits,
            static_cast<std::uint32_t>(RootEdge::seat(root) << k_seat | RootEdge::edge(root)), 0};
  }
  SADDLEBACK_STEP int end(int side) const { return static_cast<int>(slots >> k_slot_bits * side & k_slot); }
  SADDLEBACK_STEP int apex() const { return static_cast<int>(slots >> 2 * k_slot_bits); }
  SADDLEBACK_STEP int root() const {
    return RootEdge::pack(static_cast<int>(origin >> k_seat & 1), static_cast<int>(origin & (k_most_edges - 1)));
  }
  SADDLEBACK_STEP int generation() const {
    return static_cast<int>(origin >> k_generation & ((1u << k_generation_bits) - 1));
  }
  SADDLEBACK_STEP std::uint32_t turns() const { return origin >> k_turns; }
  SADDLEBACK_STEP void note_apex(DenseLinks& there, int slot) const {
    there.slots = slots | static_cast<std::uint32_t>(slot) << 2 * k_slot_bits;
  }
  /// Sets the turns in place of as many generations as the numbers have bits.
  SADDLEBACK_STEP void set_turns(std::uint32_t number, int bits) {
    origin =
        (origin & ((1u << k_generation) - 1)) | static_cast<std::uint32_t>(bits) << k_generation | number << k_turns;
  }
  SADDLEBACK_STEP DenseLinks child(std::int32_t behind, int side, int) const {
    return {behind, (slots & k_slot << k_slot_bits * side) | (slots >> 2 * k_slot_bits) << k_slot_bits * (1 - side),
            (origin | static_cast<std::uint32_t>(side) << (k_turns + generation())) + (1u << k_generation), most};
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

/// A side of a window's face that its cone covers: the window's number in its generation, and whether it is the right
/// side.
struct Cone {
  static constexpr int k_right = 1 << 15, k_number = k_right - 1;
};

/// A warp's windows: a ring, in which those of a generation lie one behind the other, so that lanes with neighbors ask
/// for different banks. *Left* is 0 and *right* is 1 of what there is two of. Less for each leaves room for more warps:
/// where disks end by count, apexes are computed again.
template <bool All_, int Windows_, int Slots>
struct alignas(16) WindowPool {
  static constexpr bool All = All_, is_dense = !All && Slots <= 1 << DenseLinks::k_slot_bits;
  static constexpr int Windows = Windows_;
  using Links = std::conditional_t<is_dense, DenseLinks, WindowLinks>;
  /// Sizes the cones; in the dense one they are a ring, a power of two.
  static constexpr int Cones = is_dense ? (Windows <= 80 ? 128 : 256) : Windows + (All ? Windows / 4 : 3 * Windows / 8);
  static_assert(Windows <= Cone::k_number && Windows % 4 == 0);
  double2 ends[2][Windows];           ///< of the half-edge: start, which is on the left, and end
  double2 apexes[All ? 1 : Windows];  ///< once they are sighted
  Links links[Windows];
  WindowRay<All> rays[2][Windows];
  float served[2][All ? 1 : Windows];         ///< tangents, as of WindowRows
  float ways[All ? 1 : Windows];              ///< to the apexes
  float most[All || is_dense ? 1 : Windows];  ///< radius beyond which a window serves nothing, see DenseLinks
  std::uint16_t cones[Cones];
};

/// The vertices that the sources reached.
template <bool All_, int Slots_>
struct alignas(16) WaveTable {
  static constexpr bool All = All_;
  static constexpr int Slots = Slots_, Todo = 96, Draft = Slots + Slots / 2;  ///< sightings that make arcs
  using Sighted = SightedAt<!All && Slots <= 1 << DenseLinks::k_slot_bits>;
  static_assert(Slots % 128 == 0);
  std::int32_t labels[Slots];
  std::uint32_t keys[Slots];                    ///< nodes, and whose they are
  std::uint32_t changed[All ? Slots / 32 : 1];  ///< bits: the label may have to be offered to neighbors
  std::uint16_t todo[All ? Todo : 1];
};

SADDLEBACK_STEP float distance_of(std::int32_t label) { return __int_as_float(label); }
SADDLEBACK_STEP std::int32_t label_of(float distance, bool makes_arc) {
  const std::int32_t bits = __float_as_int(distance) & ~1;
  return makes_arc ? bits : bits | 1;
}
/// Computes it as Eigen's norm.
SADDLEBACK_STEP double norm_of(double x, double y) { return __dsqrt_rn(x * x + y * y); }

}  // namespace
}  // namespace saddleback
