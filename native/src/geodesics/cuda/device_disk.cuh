#pragma once
// The knowledge of a warp about the vertices near its sources: labels by slot, and, where disks end by count, their
// radius.

#include <cstdint>

#include "geodesics/cuda/device_window_memory.cuh"
#include "support/cuda/warp.cuh"

namespace saddleback {
namespace {

// As in geodesic_disks.cpp.
constexpr float k_disk_as_far = 1 + 1e-5f;
constexpr float k_bend_longer = 1 + 1e-6f;

/// Labels that a warp looks through again and again: few are kept at hand.
template <int Slots>
class LookedThrough {
  static constexpr int k_fours = Slots / 128;
  static constexpr bool at_hand = k_fours <= 4;

 public:
  SADDLEBACK_STEP explicit LookedThrough(const std::int32_t* labels)
      : labels_(reinterpret_cast<const int4*>(labels) + (threadIdx.x & 31)) {
    if constexpr (at_hand) {
#pragma unroll
      for (int i = 0; i < k_fours; ++i) fours_[i] = labels_[32 * i];
    }
  }
  SADDLEBACK_STEP int count_up_to(std::int32_t most) const {
    int count = 0;
    each([&](std::int32_t label) { count += label <= most; });
    return warp_sum(count);
  }
  /// The largest of them, and their number.
  SADDLEBACK_STEP std::int32_t last_up_to(std::int32_t most, int* through) const {
    std::int32_t last = 0;
    int count = 0;
    each([&](std::int32_t label) {
      const bool counts = label <= most;
      last = max(last, counts ? label : 0);
      count += counts;
    });
    *through = warp_sum(count);
    return warp_max(last);
  }

 private:
  template <class Use>
  SADDLEBACK_STEP void each(Use&& use) const {
#pragma unroll 4
    for (int i = 0; i < k_fours; ++i) {
      const int4 four = at_hand ? fours_[at_hand ? i : 0] : labels_[32 * i];
      use(four.x);
      use(four.y);
      use(four.z);
      use(four.w);
    }
  }

  const int4* labels_;  ///< the lane's own
  int4 fours_[at_hand ? k_fours : 1];
};
/// Guesses a label between two, as if vertices were spread evenly over the disk.
SADDLEBACK_STEP std::int32_t guess_label(std::int32_t low, std::int32_t high, int below, int through, int wanted) {
  const float inner = low < 0 ? 0 : distance_of(low), outer = distance_of(high);
  const float share = Simd::quotient(static_cast<float>(wanted - below), static_cast<float>(through - below));
  const float radius = Simd::sqrt(inner * inner + (outer * outer - inner * inner) * share);
  return max(low + 1, min(__float_as_int(radius), high - 1));
}
/// The n-th of the labels in the order of their sizes, of those up to `most`; k_unreached_label when there are not so
/// many. By all lanes of a warp.
template <int Slots>
SADDLEBACK_STEP std::int32_t nth_label(const std::int32_t* those, int n, std::int32_t most) {
  const LookedThrough<Slots> labels(those);
  int below = 0, through = 0;  // labels up to low, and up to high
  std::int32_t low = -1, high = labels.last_up_to(min(most, k_unreached_label - 1), &through);
  if (through < n) return k_unreached_label;
  // The second guess knows what the first has told, and is a good one. From then on every other try halves what is
  // left, so that it ends.
  for (int tries = 0; through != n && high - low > 1; ++tries) {
    const bool guesses = tries < 2 || tries % 2 == 0;
    const std::int32_t middle = guesses ? guess_label(low, high, below, through, n) : low + (high - low) / 2;
    const int there = labels.count_up_to(middle);
    if (there >= n) {
      high = middle;
      through = there;
    } else {
      low = middle;
      below = there;
    }
  }
  return labels.last_up_to(high, &through);
}

/// The CUDA counterpart of GeodesicDisks's labels. `Seats` sources share the table.
template <class Table, int Seats>
class WarpDisk {
  static constexpr int k_slots = Table::Slots;

 public:
  static constexpr bool All = Table::All;
  static_assert(!All || Seats == 1);

  SADDLEBACK_STEP WarpDisk(const DeviceMesh& mesh, Table& table)
      : mesh_(mesh), table_(table), lane_(threadIdx.x & 31) {}

  SADDLEBACK_STEP void clear() {
    const int4 unreached{k_unreached_label, k_unreached_label, k_unreached_label, k_unreached_label};
    const int4 empty{-1, -1, -1, -1};
    for (int i = lane_; i < k_slots / 4; i += 32) {
      reinterpret_cast<int4*>(table_.labels)[i] = unreached;
      reinterpret_cast<int4*>(table_.keys)[i] = empty;
    }
    if constexpr (All)
      for (int i = lane_; i < k_slots / 32; i += 32) table_.changed[i] = 0;
    limit_ = distance_of(k_unreached_label);
    overflow_ = 0;
    __syncwarp();
  }

  SADDLEBACK_STEP float radius() const { return limit_; }
  SADDLEBACK_STEP bool is_bounded() const { return limit_ < distance_of(k_unreached_label); }
  SADDLEBACK_STEP bool overflowed() const { return overflow_ != 0; }
  SADDLEBACK_STEP bool overflowed_anywhere() const { return __any_sync(k_warp, overflow_); }
  SADDLEBACK_STEP std::int32_t label(int slot) const { return table_.labels[slot]; }
  SADDLEBACK_STEP std::int32_t node(int slot) const { return DiskKey<Seats>::node(table_.keys[slot]); }
  SADDLEBACK_STEP int seat(int slot) const { return DiskKey<Seats>::seat(table_.keys[slot]); }

  /// A search for the slot of a node, by open addressing over buckets of four.
  struct Probe {
    static constexpr int k_others_were_first = -1, k_is_full = -2;
    bool active;
    std::uint32_t key;
    int bucket;
    int slot;  ///< negative: not there yet, and why
  };
  /// The slots of the lanes' nodes, made if need be, are found in two steps with room for other work between them,
  /// since memory takes its time. By all lanes of the warp; of no meaning for those that are not active.
  SADDLEBACK_STEP Probe probe(bool active, std::uint32_t key) {
    Probe probe{active, key, static_cast<int>(__umulhi(key * 2654435769u, k_slots / 4)), 0};
    look_up(probe);
    return probe;
  }
  SADDLEBACK_STEP int settle(Probe probe) {
    probe.active = probe.active && probe.slot < 0;
    for (int tries = 0; __any_sync(k_warp, probe.active); ++tries) {
      if (tries > k_slots / 2) {
        overflow_ = 1;
        break;
      }
      __syncwarp();
      Probe again = probe;
      if (probe.slot == Probe::k_is_full) again.bucket = probe.bucket + 1 < k_slots / 4 ? probe.bucket + 1 : 0;
      look_up(again);
      probe.bucket = again.bucket;
      probe.slot = probe.active ? again.slot : probe.slot;
      probe.active = probe.active && again.slot < 0;
    }
    return max(probe.slot, 0);
  }
  SADDLEBACK_STEP int insert(bool active, std::uint32_t key) { return settle(probe(active, key)); }

  /// Lowers the bound where `seen`. `bends` unless only straight ways are known to go on from there: the label then has
  /// to be offered to neighbors. Lanes that have seen nothing change nothing, each at another address: a branch would
  /// take longer.
  SADDLEBACK_STEP void lower(bool seen, int slot, std::int32_t label, bool bends) {
    const std::int32_t before = atomicMin(&table_.labels[seen ? slot : lane_], seen ? label : k_unreached_label);
    if constexpr (All) {
      const bool changes = seen & bends & (label < before);
      auto* const place =
          changes ? &table_.changed[slot / 32] : reinterpret_cast<std::uint32_t*>(&table_.labels[lane_]);
      atomicOr(place, changes ? 1u << (slot % 32) : 0u);
    }
  }

  /// Lowers the radius of the disk to that of the k-th nearest vertex, as far as is known.
  SADDLEBACK_STEP bool bound() {
    __syncwarp();
    const std::int32_t last = nth_label<k_slots>(table_.labels, mesh_.k + 1, __float_as_int(limit_));
    if (last == k_unreached_label) return false;
    return lower_radius(distance_of(last) * k_disk_as_far);  // a node is its own nearest
  }
  SADDLEBACK_STEP bool lower_radius(float radius) {
    if (!(radius < limit_)) return false;
    limit_ = radius;
    return true;
  }

  /// Works as GeodesicDisks::relax_bends: what bends make of the labels does not depend on the order in which they are
  /// told.
  SADDLEBACK_STEP void relax_bends() {
    if (!is_bounded()) return;
    while (const int count = list_changed()) {
      const int tellers = list_tellers(count);
      tell_neighbors(tellers, Bend{table_, limit_});
      if (overflowed_anywhere()) return;
    }
  }

  /// Tells the neighbors of all on the list: rule.offer(disk, whether rule.serves(label), slot of a neighbor, label),
  /// with label = rule.label(rule.from(slot), length of the edge). By all lanes of the warp, a block each eight; blocks
  /// are asked for ahead.
  template <class Rule>
  SADDLEBACK_STEP void tell_neighbors(int count, const Rule& rule) {
    if (count == 0) return;
    const int own = lane_ / Neighbor::k_block;
    const auto teller = [&](int first) { return static_cast<int>(table_.todo[min(first + own, count - 1)]); };
    Neighbor ahead = neighbor_in(node(teller(0)));
    for (int first = 0; first < count; first += 32 / Neighbor::k_block) {
      Neighbor there = ahead;
      if (first + 32 / Neighbor::k_block < count) ahead = neighbor_in(node(teller(first + 32 / Neighbor::k_block)));
      if (first + own >= count) there.key = Neighbor::k_none;
      const float from = rule.from(teller(first));
      tell(there, from, rule);
      while (__any_sync(k_warp, there.goes_on())) {
        const std::int32_t block = there.goes_on() ? static_cast<std::int32_t>(there.key & ~Neighbor::k_link) : -1;
        const std::int32_t next = __shfl_sync(k_warp, block, lane_ | (Neighbor::k_block - 1));
        there = next >= 0 ? neighbor_in(next) : Neighbor{Neighbor::k_none, 0};
        tell(there, from, rule);
      }
    }
  }

 private:
  /// Offers labels where shortest ways bend: longer by more than rounding, so that what is collinear stays an arc.
  struct Bend {
    const Table& table;
    float limit;
    SADDLEBACK_STEP float from(int slot) const { return distance_of(table.labels[slot]); }
    SADDLEBACK_STEP static std::int32_t label(float from, float length) {
      return label_of((from + length) * k_bend_longer, false);
    }
    SADDLEBACK_STEP bool serves(std::int32_t label) const { return distance_of(label) < limit; }
    SADDLEBACK_STEP static void offer(WarpDisk& disk, bool serves, int slot, std::int32_t label) {
      disk.lower(serves, slot, label, true);
    }
  };

  SADDLEBACK_STEP Neighbor neighbor_in(std::int32_t block) const {
    return mesh_.neighbors[block * Neighbor::k_block + (lane_ & (Neighbor::k_block - 1))];
  }
  template <class Rule>
  SADDLEBACK_STEP void tell(const Neighbor& there, float from, const Rule& rule) {
    const std::int32_t label = rule.label(from, there.length);
    const bool is_told = there.is_node() & rule.serves(label);
    const int other = insert(is_told, there.key);
    rule.offer(*this, is_told, other, label);
    __syncwarp();
  }

  /// Looks the key up in one bucket of four, which are filled from the first entry on: what is in none of a bucket that
  /// has room is nowhere.
  SADDLEBACK_STEP void look_up(Probe& probe) {
    const uint4 there = reinterpret_cast<const uint4*>(table_.keys)[probe.bucket];
    const bool has_room = there.w == k_no_key;
    int at = there.x == probe.key ? 0 : -1;
    at = there.y == probe.key ? 1 : at;
    at = there.z == probe.key ? 2 : at;
    at = there.w == probe.key ? 3 : at;
    const bool makes = probe.active & (at < 0) & has_room;
    int vacant = there.z == k_no_key ? 2 : 3;
    vacant = there.y == k_no_key ? 1 : vacant;
    vacant = there.x == k_no_key ? 0 : vacant;
    // Others change nothing, each somewhere else: to branch takes longer.
    const std::uint32_t before =
        atomicCAS(&table_.keys[makes ? 4 * probe.bucket + vacant : lane_], makes ? k_no_key : k_never_a_key, probe.key);
    at = makes & ((before == k_no_key) | (before == probe.key)) ? vacant : at;
    probe.slot = at >= 0 ? 4 * probe.bucket + at : has_room ? Probe::k_others_were_first : Probe::k_is_full;
  }

  /// Takes slots that are marked as changed into the list of those to do. \return how many
  SADDLEBACK_STEP int list_changed() {
    __syncwarp();
    int count = 0;
    for (int base = 0; base < k_slots / 32 && count < Table::Todo; base += 32) {
      const int at = base + lane_;
      std::uint32_t word = at < k_slots / 32 ? table_.changed[at] : 0;
      if (__any_sync(k_warp, word != 0)) count = list_word(word, at, count);
    }
    __syncwarp();
    return count;
  }
  /// Leaves marked what the list has no room for.
  SADDLEBACK_STEP int list_word(std::uint32_t word, int at, int count) {
    const int through = warp_sum_through(__popc(word));
    int next = count + through - __popc(word);
    const bool any = word != 0;
    for (; word != 0 && next < Table::Todo; word &= word - 1)
      table_.todo[next++] = static_cast<std::uint16_t>(32 * at + __ffs(static_cast<int>(word)) - 1);
    if (any) table_.changed[at] = word;
    return min(count + __shfl_sync(k_warp, through, 31), Table::Todo);
  }

  /// Keeps those on the list that have something to tell. \return how many
  SADDLEBACK_STEP int list_tellers(int count) {
    int tellers = 0;
    for (int base = 0; base < count; base += 32) {
      const int slot = table_.todo[min(base + lane_, count - 1)];
      const std::int32_t label = table_.labels[slot];
      const bool tells = base + lane_ < count && distance_of(label) < limit_ &&
                         ((label & 1) != 0 || DiskKey<Seats>::is_saddle(table_.keys[slot]));
      const unsigned lanes = __ballot_sync(k_warp, tells);
      __syncwarp();
      if (tells) table_.todo[tellers + __popc(lanes & ((1u << lane_) - 1))] = static_cast<std::uint16_t>(slot);
      tellers += __popc(lanes);
      __syncwarp();
    }
    return tellers;
  }

  const DeviceMesh& mesh_;
  Table& table_;
  int lane_;
  float limit_ = 0;
  int overflow_ = 0;  ///< whether the table is full
};

}  // namespace
}  // namespace saddleback
