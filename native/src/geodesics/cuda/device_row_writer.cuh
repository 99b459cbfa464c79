#pragma once
// The rows of arcs of a warp's sources, from what these have seen.

#include <cstdint>

#include "geodesics/cuda/device_union.cuh"
#include "geodesics/cuda/device_windows.cuh"

namespace saddleback {
namespace {

/// Takes the place of the windows when there are none any more.
template <class Table, int Seats>
struct BestSightings {
  static constexpr int Slots = Table::Slots, Kept = 2 * Slots / Seats, Words = Table::Draft / 32 + 1;
  std::int32_t labels[Slots];          ///< of the shortest arcs
  std::int32_t numbers[Slots];         ///< in the draft, of the first of them
  std::uint16_t places[Table::Draft];  ///< SightedAt
  std::uint16_t kept[Seats][Kept];
  std::uint32_t begins[Words];  ///< bits, see Sighting::k_begins
};

SADDLEBACK_STEP int to_sector(float sector) {
  const int whole = static_cast<int>(sector);
  return whole < 0 ? 0 : whole > 255 ? 255 : whole;
}

/// Writes rows as GeodesicDisks::choose and DiskRows do it.
template <class Waves, class Table, int Seats>
class RowWriter {
  using Best = BestSightings<Table, Seats>;
  using Sighted = typename Table::Sighted;

 public:
  SADDLEBACK_STEP RowWriter(const DeviceMesh& mesh, const Waves& waves, Best& best)
      : mesh_(mesh), waves_(waves), best_(best), lane_(threadIdx.x & 31) {}

  /// False when there is not the room.
  SADDLEBACK_STEP bool write(const DeviceRows& rows) {
    find_best();
    int counts[Seats] = {};
    if (!list_kept(counts)) return false;
    int total = 0;
    for (int seat = 0; seat < Seats; ++seat) total += counts[seat];
    const RowPlace place = rows.reserve(total);
    std::int64_t first = place.first;
    for (int seat = 0; seat < Seats; ++seat) {
      if (lane_ == 0 && seat < waves_.sources().count) rows.note(waves_.sources().node + seat, first, counts[seat]);
      first += counts[seat];
    }
    const std::int32_t node = waves_.sources().node, last = node + waves_.sources().count - 1;
    const Source sources[] = {{mesh_.first[node], mesh_.per_radian[node]}, {mesh_.first[last], mesh_.per_radian[last]}};
    for (int i = lane_; place.fits && i < total; i += 32) put(rows, place.first + i, chosen(i, counts[0], sources));
    __syncwarp();
    return true;
  }

 private:
  static_assert(Seats <= 2);
  static constexpr int k_first_kept = 1 << 15;  ///< in the list of what is kept: of its generation

  SADDLEBACK_STEP void find_best() {
    for (int i = lane_; i < Table::Slots; i += 32) {
      best_.labels[i] = k_unreached_label;
      best_.numbers[i] = k_unreached_label;
    }
    for (int i = lane_; i < Best::Words; i += 32) best_.begins[i] = 0;
    __syncwarp();
    const Sighting* const draft = waves_.draft();
#pragma unroll 4
    for (int i = lane_; i < waves_.arcs(); i += 32) {
      const uint2 seen{draft[i].ids, static_cast<unsigned>(draft[i].label)};  // in one load
      const int place = static_cast<int>(seen.x >> RootEdge::k_bits), slot = Sighted::slot(place);
      const auto label = static_cast<std::int32_t>(seen.y);
      best_.places[i] = static_cast<std::uint16_t>(place);
      atomicMin(&best_.labels[slot], label & ~Sighting::k_begins);
      if (label < 0) atomicOr(&best_.begins[i / 32], 1u << i % 32);
    }
    __syncwarp();
    bool tied = false;
#pragma unroll 4
    for (int i = lane_; i < waves_.arcs(); i += 32) {
      const int slot = slot_of(i);
      if (best_.labels[slot] == label_of(draft[i])) tied |= atomicMin(&best_.numbers[slot], i) != k_unreached_label;
    }
    if (__any_sync(k_warp, tied)) break_ties();
    __syncwarp();
  }

  SADDLEBACK_STEP int slot_of(int number) const { return Sighted::slot(best_.places[number]); }
  SADDLEBACK_STEP static std::int32_t label_of(const Sighting& seen) { return seen.label & ~Sighting::k_begins; }
  SADDLEBACK_STEP static std::uint32_t order_of(const Sighting& seen) {
    return order_in_generation(seen.turns, RootEdge::edge(seen.root()));
  }

  /// Breaks ties: of sightings of the same label it is the processor's first that counts.
  SADDLEBACK_STEP void break_ties() {
    __syncwarp();
    const Sighting* const draft = waves_.draft();
    for (int i = lane_; i < waves_.arcs(); i += 32) {
      const int slot = slot_of(i);
      if (best_.labels[slot] != label_of(draft[i])) continue;
      for (int first = best_.numbers[slot]; comes_before(i, first);) {
        const int before = first;
        first = atomicCAS(&best_.numbers[slot], before, i);
        if (first == before) break;
      }
    }
  }
  SADDLEBACK_STEP bool comes_before(int a, int b) const {
    bool same_generation = min(a, b) >= waves_.links() && best_.places[a] == best_.places[b];
    for (int i = min(a, b) + 1; i <= max(a, b) && same_generation; ++i)
      same_generation = (best_.begins[i / 32] >> i % 32 & 1) == 0;
    return same_generation ? order_of(waves_.draft()[a]) < order_of(waves_.draft()[b]) : a < b;
  }

  /// An arc that is not the shortest way stays as long as others may rely on it; edges stay even where something
  /// shorter, but no arc, was found.
  SADDLEBACK_STEP bool is_kept(int number) const {
    const int slot = slot_of(number);
    const float reach = distance_of(best_.labels[slot]);
    const bool stays = reach <= mesh_.slack * static_cast<double>(distance_of(waves_.disk().label(slot))) &&
                       reach <= waves_.disk().radius();
    const bool is_shortest = best_.numbers[slot] == number;
    return number < waves_.links() ? is_shortest || !stays : is_shortest && stays;
  }

  /// Begins with what the source is linked with, which is in its order already, as if each were a generation.
  SADDLEBACK_STEP bool list_kept(int (&counts)[Seats]) {
    bool fits = waves_.arcs() <= k_first_kept;
    int generations = 0, last[Seats] = {};  // so far; of the last that is kept
    for (int base = 0; base < waves_.arcs() && fits; base += 32) {
      const int number = base + lane_;
      const bool kept = number < waves_.arcs() && is_kept(number);
      const int place = best_.places[min(number, waves_.arcs() - 1)];
      const int seat = Seats > 1 && kept ? waves_.disk().seat(Sighted::slot(place)) : 0;
      const std::uint32_t begins = best_.begins[base / 32];
      const int generation = 32 * (generations + __popc(begins & (2u << lane_) - 1)) + Sighted::generation(place);
      generations += __popc(begins);
#pragma unroll
      for (int s = 0; s < Seats; ++s) {
        const unsigned lanes = __ballot_sync(k_warp, kept && seat == s), below = lanes & ((1u << lane_) - 1);
        fits = fits && counts[s] + __popc(lanes) <= Best::Kept;
        const int before = __shfl_sync(k_warp, generation, 31 - __clz(static_cast<int>(below)));
        const bool is_first = number < waves_.links() || (below != 0 ? before : last[s]) != generation;
        if (kept && seat == s && fits)
          best_.kept[s][counts[s] + __popc(below)] = static_cast<std::uint16_t>(number | (is_first ? k_first_kept : 0));
        counts[s] += __popc(lanes);
        if (lanes != 0) last[s] = __shfl_sync(k_warp, generation, 31 - __clz(static_cast<int>(lanes)));
      }
    }
    __syncwarp();
    return fits;
  }

  /// A sighting that becomes an arc, and what of the mesh its directions go by.
  struct Chosen {
    Sighting seen;
    bool is_window;
    std::uint32_t order;
    std::int32_t target;
    float leaving, back, per_radian, per_radian_back;
  };

  /// Holds what all arcs of a source need of the mesh.
  struct Source {
    std::int32_t first;  ///< half-edge
    float per_radian;
  };

  /// The `i`-th of what is kept, of which the first source has `count`.
  SADDLEBACK_STEP Chosen chosen(int i, int count, const Source (&sources)[2]) const {
    const int seat = Seats > 1 && i >= count ? 1 : 0;
    const int kept = best_.kept[seat][seat == 0 ? i : i - count], number = kept & (k_first_kept - 1);
    const Sighting seen = waves_.draft()[number];
    const std::int32_t root = (seat == 0 ? sources[0].first : sources[1].first) + RootEdge::edge(seen.root());
    const std::uint32_t order = order_of(seen) | ((kept & k_first_kept) != 0 ? k_new_generation : 0);
    Chosen arc{seen, number >= waves_.links(), order, waves_.disk().node(Sighted::slot(seen.seen_at())), 256, 0, 0, 0};
    if (arc.is_window) {
      arc.leaving = mesh_.sectors[root];
      arc.back = mesh_.apex_sectors[seen.edge];
      arc.per_radian = seat == 0 ? sources[0].per_radian : sources[1].per_radian;
      arc.per_radian_back = mesh_.per_radian[arc.target];
    } else if (seen.edge == 0) {
      arc.leaving = mesh_.sectors[root];
      arc.back = mesh_.reverse_sectors[root];
    } else {  // at the boundary
      arc.back = mesh_.apex_sectors[root];
    }
    return arc;
  }

  SADDLEBACK_STEP void put(const DeviceRows& rows, std::int64_t at, const Chosen& arc) const {
    const Sighting& seen = arc.seen;
    float leaving = arc.leaving, back = arc.back;
    if (arc.is_window) {
      const float x = static_cast<float>(seen.place.x), y = static_cast<float>(seen.place.y);
      const float side_x = static_cast<float>(seen.from.x - seen.place.x);
      const float side_y = static_cast<float>(seen.from.y - seen.place.y);
      leaving += angle_of(x, y) * arc.per_radian;
      back += angle_back(x, y, side_x, side_y) * arc.per_radian_back;
    }
    const double length = norm_of(seen.place.x, seen.place.y);
    rows.put(at, mesh_.packing.pack(arc.target, to_sector(leaving), length * mesh_.unit),
             static_cast<std::uint8_t>(to_sector(back)), arc.order);
  }

  const DeviceMesh& mesh_;
  const Waves& waves_;
  Best& best_;
  int lane_;
};

}  // namespace
}  // namespace saddleback
