#pragma once
// What the windows of a warp's source are kept in.
//
// What a source sees of the mesh is in a hash table of its own, since it reaches a hundred vertices or two of all there
// are; a *slot* is an entry of that table.

#include <cstdint>

#include "geodesics/arc_twin.h"
#include "geodesics/device_lane.cuh"

namespace saddleback {
namespace {

constexpr std::uint32_t k_no_key = 0xffffffffu;
constexpr std::int32_t k_unreached_label = 0x7f800000;
constexpr std::uint64_t k_no_arc = static_cast<std::uint64_t>(k_unreached_label) << 32 | 0xffffffffu;
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
};

/// A vertex seen, until it is known whether an arc to it stays: the directions are computed only then.
struct Sighting {
  double2 place;            ///< of the vertex
  float2 side;              ///< from it to the start of the half-edge that the window came through
  std::int32_t edge, root;  ///< of the window; a link of the source has ~edge as root, and whether it is the other side
  std::int32_t slot;
  std::int32_t unused;
};

/// A warp's windows: a ring of those behind left sides, and behind it one of those behind right ones.
template <bool All, int Ring_>
struct alignas(16) WaveRings {
  static constexpr int Ring = Ring_, Room = 2 * Ring;
  double2 from[Room], to[Room];
  float4 rays[Room];  ///< right_x, right_y, left_x, left_y
  float2 reaches[Room];
  float2 ways[All ? 1 : Room];
  std::int32_t edges[Room];  ///< records
  std::int32_t roots[Room];
  float most[All ? 1 : Room];
  ushort2 ends[Room];  ///< slots of the half-edge's ends
  std::uint16_t apexes[Room];
};

/// The vertices that a warp's source reached.
template <bool All, int Slots_>
struct alignas(16) WaveTable {
  static constexpr int Slots = Slots_;
  std::uint64_t arcs[Slots];  ///< label of the shortest arc, and its number in the draft
  std::int32_t labels[Slots];
  std::uint32_t keys[Slots];                    ///< nodes
  std::uint32_t changed[All ? Slots / 32 : 1];  ///< bits: neighbours may have to be told of the label
  std::uint16_t todo[All ? Slots : 1];
};

SADDLEBACK_STEP float distance_of(std::int32_t label) { return __int_as_float(label); }
SADDLEBACK_STEP std::int32_t label_of(float distance, bool makes_arc) {
  const std::int32_t bits = __float_as_int(distance) & ~1;
  return makes_arc ? bits : bits | 1;
}
SADDLEBACK_STEP int to_sector(float sector) {
  const int whole = static_cast<int>(sector);
  return whole < 0 ? 0 : whole > 255 ? 255 : whole;
}
/// As Eigen's norm.
SADDLEBACK_STEP double norm_of(double x, double y) { return __dsqrt_rn(x * x + y * y); }

}  // namespace
}  // namespace saddleback
