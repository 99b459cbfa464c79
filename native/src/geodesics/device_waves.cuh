#pragma once
// Windows of a source, kept and advanced by the 32 lanes of a warp: the twin of DiskFinder, to the bit.
//
// As there, generations have no order but their own: all windows of one look at their apexes, the labels are lowered,
// then all are split.

#include <cstdint>

#include "geodesics/device_wave_memory.cuh"
#include "support/warp.cuh"

namespace saddleback {
namespace {

// As in disk_finder.cpp.
constexpr float k_disk_as_far = 1 + 1e-5f;
constexpr float k_bend_longer = 1 + 1e-6f;

/// One window as its lane holds it.
struct LaneWindow {
  double2 from, to;
  Rays rays;
  float right_way, left_way, most;
  std::int32_t edge, root;
  ushort2 ends;
};

/// The far corner of a window's face, as its lane sees it.
struct LaneApex {
  double x, y;
  ApexView view;
  float way;
  bool direct, is_saddle;
  std::int32_t left, right, node;
  std::uint32_t clearances;
};

/// A source from its first windows to its row of arcs.
template <bool All, class Table, class Rings>
class WarpWaves {
  static constexpr int k_ring = Rings::Ring, k_slots = Table::Slots;

 public:
  /// `draft` has room for the sightings that make arcs.
  SADDLEBACK_STEP WarpWaves(const DeviceMesh& mesh, Table& table, Rings& rings, Sighting* draft, int draft_room)
      : mesh_(mesh), table_(table), rings_(rings), draft_(draft), draft_room_(draft_room), lane_(threadIdx.x & 31) {}

  SADDLEBACK_STEP void begin(std::int32_t node) {
    for (int i = lane_; i < k_slots; i += 32) {
      table_.keys[i] = k_no_key;
      table_.labels[i] = k_unreached_label;
      table_.arcs[i] = k_no_arc;
    }
    if constexpr (All)
      for (int i = lane_; i < k_slots / 32; i += 32) table_.changed[i] = 0;
    node_ = node;
    limit_ = __int_as_float(k_unreached_label);
    left_head_ = right_head_ = left_count_ = right_count_ = 0;
    arcs_ = 0;
    generation_ = 0;
    overflow_ = false;
    __syncwarp();
    if (lane_ == 0) {
      const int centre = insert(node);
      if (centre >= 0) table_.labels[centre] = label_of(0, false);
    }
    __syncwarp();
    const std::int32_t end = mesh_.first[node + 1];
    for (std::int32_t base = mesh_.first[node]; base < end; base += 32) add_edges(base + lane_, end);
    links_ = arcs_;
  }

  /// To the last generation. False when the memory did not do.
  SADDLEBACK_STEP bool run() {
    while (!overflowed()) {
      const int lefts = left_count_, all = lefts + right_count_;
      if (all == 0) break;
      int slot = 0;
      LaneWindow w;
      LaneApex apex;
      for (int base = 0; base < all; base += 32) slot = sight(base, lefts, all, w, apex);
      if (overflowed()) break;
      bend();
      int lefts_used = 0, rights_used = 0;
      for (int base = 0; base < all; base += 32) {
        const int now = min(32, all - base), lefts_now = max(0, min(32, lefts - base));
        if (all > 32) {  // otherwise what a window saw is still in its lane
          const int p = base + (lane_ < now ? lane_ : 0);
          const int place = p < lefts ? wrapped(left_head_ + p - lefts_used)
                                      : k_ring + wrapped(right_head_ + p - lefts - rights_used);
          w = load(place);
          apex = look(w);
          slot = rings_.apexes[place];
          __syncwarp();
        }
        left_head_ = wrapped(left_head_ + lefts_now);
        left_count_ -= lefts_now;
        right_head_ = wrapped(right_head_ + now - lefts_now);
        right_count_ -= now - lefts_now;
        lefts_used += lefts_now;
        rights_used += now - lefts_now;
        split(lane_ < now, w, apex, slot);
        if (overflowed()) break;
      }
    }
    if constexpr (All) {
      for (bool smaller = true; smaller && !overflowed();) {
        smaller = bound_disk();
        relax_bends();
      }
    }
    return !overflowed();
  }

  /// Calls use(sighting, lanes) for the arcs to keep, 32 sightings at a time: `lanes` are those that hold one.
  template <class Use>
  SADDLEBACK_STEP void for_each_kept(Use&& use) const {
    for (int base = 0; base < arcs_; base += 32) {
      const int i = base + lane_;
      bool kept = false;
      if (i < arcs_) {
        const int slot = draft_[i].slot;
        const bool shortest = static_cast<std::uint32_t>(table_.arcs[slot]) == static_cast<std::uint32_t>(i);
        kept = i < links_ ? shortest || !is_kept(slot) : shortest && is_kept(slot);
      }
      use(draft_[i < arcs_ ? i : 0], __ballot_sync(k_warp, kept));
    }
  }

  struct Arc {
    std::uint64_t word;
    std::uint8_t back_sector;
  };
  SADDLEBACK_STEP Arc arc_of(const Sighting& seen) const {
    const auto target = static_cast<std::int32_t>(table_.keys[seen.slot]);
    float leaving, back;
    if (seen.root >= 0) {
      const float x = static_cast<float>(seen.place.x), y = static_cast<float>(seen.place.y);
      leaving = mesh_.sectors[seen.root] + angle_of(x, y) * mesh_.per_radian[node_];
      back = mesh_.apex_sectors[seen.edge] + angle_back(x, y, seen.side.x, seen.side.y) * mesh_.per_radian[target];
    } else if (seen.edge == 0) {
      leaving = mesh_.sectors[~seen.root];
      back = mesh_.reverse_sectors[~seen.root];
    } else {  // at the boundary
      leaving = 256;
      back = mesh_.apex_sectors[~seen.root];
    }
    const double length = norm_of(seen.place.x, seen.place.y);
    return {mesh_.packing.pack(target, to_sector(leaving), length * mesh_.unit),
            static_cast<std::uint8_t>(to_sector(back))};
  }

 private:
  SADDLEBACK_STEP bool overflowed() { return __any_sync(k_warp, overflow_); }
  SADDLEBACK_STEP unsigned below() const { return (1u << lane_) - 1; }

  /// The slot of a node, made if need be. Any lanes may call it at once.
  SADDLEBACK_STEP int insert(std::int32_t node) {
    const auto key = static_cast<std::uint32_t>(node);
    std::uint32_t at = __umulhi(key * 2654435769u, k_slots);
    for (int tries = 0; tries < k_slots / 2; ++tries) {
      const std::uint32_t there = table_.keys[at];
      if (there == key) return static_cast<int>(at);
      if (there == k_no_key) {
        const std::uint32_t before = atomicCAS(&table_.keys[at], k_no_key, key);
        if (before == k_no_key || before == key) return static_cast<int>(at);
      }
      if (++at == k_slots) at = 0;
    }
    overflow_ = true;
    return -1;
  }

  /// `bends` unless only straight ways are known to go on from there: neighbours then have to be told of the label.
  SADDLEBACK_STEP void lower_label(int slot, std::int32_t label, bool bends) {
    const std::int32_t before = atomicMin(&table_.labels[slot], label);
    if constexpr (All)
      if (bends && label < before) atomicOr(&table_.changed[slot / 32], 1u << (slot % 32));
  }

  SADDLEBACK_STEP void put_arc(int number, std::int32_t label, const Sighting& seen) {
    if (number >= draft_room_) {
      overflow_ = true;
      return;
    }
    atomicMin(reinterpret_cast<unsigned long long*>(&table_.arcs[seen.slot]),
              static_cast<unsigned long long>(label) << 32 | static_cast<unsigned>(number));
    draft_[number] = seen;
  }

  /// Links and first windows of the source's edges.
  SADDLEBACK_STEP void add_edges(std::int32_t e, std::int32_t end) {
    const bool active = e < end;
    EdgeRecord record{};
    double length = 1;
    std::int32_t target = 0;
    if (active) {
      record = mesh_.records[e];
      length = mesh_.lengths[e];
      target = mesh_.targets[e];
    }
    const bool boundary = active && record.left < 0;
    const unsigned actives = __ballot_sync(k_warp, active), boundaries = __ballot_sync(k_warp, boundary);
    const int number = arcs_ + __popc(actives & below()) + __popc(boundaries & below());
    const double apex_x = record.a * length, apex_y = record.b * length, other = norm_of(apex_x, apex_y);
    int to = -1, apex = -1;
    if (active) {
      to = insert(target);
      apex = insert(record.apex);
    }
    if (active && to >= 0 && apex >= 0) {
      const std::int32_t label = label_of(static_cast<float>(norm_of(length, 0)), true);
      lower_label(to, label, true);
      put_arc(number, label, {{length, 0}, {0, 0}, 0, ~e, to, 0});
      if (boundary) {
        const std::int32_t far = label_of(static_cast<float>(norm_of(other, 0)), true);
        lower_label(apex, far, true);
        put_arc(number + 1, far, {{other, 0}, {0, 0}, 1, ~e, apex, 0});
      }
    }
    const bool opens = active && record.right >= 0 && to >= 0 && apex >= 0;
    const unsigned opening = __ballot_sync(k_warp, opens);
    if (left_count_ + __popc(opening) > k_ring) {
      overflow_ = true;
    } else if (opens) {
      const int i = left_count_ + __popc(opening & below());
      const double right_reach = norm_of(length, 0), left_reach = other;
      rings_.from[i] = {apex_x, apex_y};
      rings_.to[i] = {length, 0};
      rings_.rays[i] = {static_cast<float>(length / right_reach), static_cast<float>(0 / right_reach),
                        static_cast<float>(apex_x / left_reach), static_cast<float>(apex_y / left_reach)};
      const float2 reach{static_cast<float>(right_reach), static_cast<float>(left_reach)};
      rings_.reaches[i] = reach;
      if constexpr (!All) {
        rings_.ways[i] = reach;
        rings_.most[i] = __int_as_float(k_unreached_label);
      }
      rings_.edges[i] = record.right;
      rings_.roots[i] = e;
      rings_.ends[i] = make_ushort2(static_cast<unsigned short>(apex), static_cast<unsigned short>(to));
    }
    left_count_ += __popc(opening);
    arcs_ += __popc(actives) + __popc(boundaries);
    __syncwarp();
  }

  SADDLEBACK_STEP static int wrapped(int at) { return at < k_ring ? at : at - k_ring; }

  /// Of the window that is p-th in its generation, lefts first.
  SADDLEBACK_STEP int place_of(int p, int lefts) const {
    return p < lefts ? wrapped(left_head_ + p) : k_ring + wrapped(right_head_ + p - lefts);
  }

  SADDLEBACK_STEP LaneWindow load(int place) const {
    const float4 rays = rings_.rays[place];
    const float2 reach = rings_.reaches[place];
    LaneWindow w{rings_.from[place],
                 rings_.to[place],
                 {rays.x, rays.y, rays.z, rays.w, reach.x, reach.y},
                 0,
                 0,
                 0,
                 rings_.edges[place],
                 rings_.roots[place],
                 rings_.ends[place]};
    if constexpr (!All) {
      const float2 ways = rings_.ways[place];
      w.right_way = ways.x;
      w.left_way = ways.y;
      w.most = rings_.most[place];
    }
    return w;
  }

  SADDLEBACK_STEP LaneApex look(const LaneWindow& w) const {
    const EdgeRecord& record = mesh_.records[w.edge];
    const double along_x = w.to.x - w.from.x, along_y = w.to.y - w.from.y;
    LaneApex apex;
    apex.x = w.from.x + (record.a * along_x - record.b * along_y);
    apex.y = w.from.y + (record.a * along_y + record.b * along_x);
    apex.left = record.left;
    apex.right = record.right;
    apex.node = record.apex;
    apex.is_saddle = (record.clearances & k_saddle_bit) != 0;
    apex.clearances = record.clearances & ~k_saddle_bit;
    apex.view = view_apex(static_cast<float>(apex.x), static_cast<float>(apex.y), w.rays);
    apex.direct = apex.view.inside;
    if constexpr (!All) {
      const float way = way_by_flank(apex.view, w.rays, w.right_way, w.left_way, mesh_.detour);
      apex.direct = apex.direct && mesh_.detour * apex.view.reach < way;
      apex.way = apex.direct ? apex.view.reach : way;
    }
    return apex;
  }

  /// 32 windows of the generation look at their apexes and lower the labels. \return the slot of the lane's apex.
  SADDLEBACK_STEP int sight(int base, int lefts, int all, LaneWindow& w, LaneApex& apex) {
    const bool active = base + lane_ < all;
    const int place = place_of(active ? base + lane_ : 0, lefts);
    bool makes_arc = false;
    int slot = -1;
    std::int32_t label = 0;
    w = load(place);
    apex = look(w);
    if (active) {
      slot = insert(apex.node);
      if (all > 32) rings_.apexes[place] = static_cast<std::uint16_t>(slot);
      if (slot >= 0 && apex.view.in_sight) {
        label = label_of(apex.view.reach, apex.direct);
        lower_label(slot, label, !apex.direct || apex.is_saddle);
        makes_arc = apex.direct;
      }
    }
    const unsigned making = __ballot_sync(k_warp, makes_arc);
    if (makes_arc) {
      put_arc(arcs_ + __popc(making & below()), label,
              {{apex.x, apex.y},
               {static_cast<float>(w.from.x - apex.x), static_cast<float>(w.from.y - apex.y)},
               w.edge,
               w.root,
               slot,
               0});
    }
    arcs_ += __popc(making);
    __syncwarp();
    return slot;
  }

  SADDLEBACK_STEP void bend() {
    if constexpr (All) {
      if (++generation_ % k_generations_per_bound != 0) return;
      bound_disk();
      // Where few vertices are in sight: the processor bounds such disks by edges.
      if (generation_ >= k_blind_generations && !(limit_ < distance_of(k_unreached_label))) overflow_ = true;
      relax_bends();
    }
  }

  /// The children of each lane's window, into the rings.
  SADDLEBACK_STEP void split(bool active, const LaneWindow& w, const LaneApex& apex, int slot) {
    FacePlaces face{static_cast<float>(w.from.x),
                    static_cast<float>(w.from.y),
                    static_cast<float>(w.to.x),
                    static_cast<float>(w.to.y),
                    distance_of(table_.labels[w.ends.x]),
                    distance_of(table_.labels[w.ends.y]),
                    distance_of(table_.labels[active ? slot : 0])};
    ApexView view = apex.view;
    Rays rays = w.rays;
    ApexRay ray = ray_to(view);
#pragma unroll
    for (int ring = 0; ring < 2; ++ring) {
      const Side side = left_side(face, view, rays, active && (ring == 0 ? apex.left : apex.right) >= 0);
      put_child(ring, side, look_at(side), ray, w, apex, slot);
      face = mirrored(face);
      view = mirrored(view);
      rays = mirrored(rays);
      ray.y = 0 - ray.y;
    }
  }

  SADDLEBACK_STEP void put_child(int ring, const Side& side, const Child& child, const ApexRay& ray,
                                 const LaneWindow& w, const LaneApex& apex, int slot) {
    float most = w.most;
    if constexpr (All) {
      most = limit_;
    } else if (apex.view.inside && child.useful) {
      most = bound_child(side, ray, {apex.view.reach, apex.way},
                         {ring == 0 ? w.rays.left_reach : w.rays.right_reach, ring == 0 ? w.left_way : w.right_way},
                         mesh_.excess, w.most);
    }
    const std::uint32_t clearance = ring == 0 ? apex.clearances & k_upper_half : apex.clearances << 16;
    const bool keep = child.useful && is_within(child, most, __int_as_float(static_cast<std::int32_t>(clearance)));
    const unsigned keeping = __ballot_sync(k_warp, keep);
    const int count = ring == 0 ? left_count_ : right_count_;
    if (count + __popc(keeping) > k_ring) {
      overflow_ = true;
      return;
    }
    if (keep) {
      const int head = ring == 0 ? left_head_ : right_head_;
      const int i = ring * k_ring + wrapped(wrapped(head + count) + __popc(keeping & below()));
      // The apex's ray takes the place of the far one where the light ends there.
      const bool left = ring == 0, right_is_apex = left && side.cut, left_is_apex = !left && side.cut;
      const float2 apex_ray{ray.x, left ? ray.y : -ray.y};
      const double2 place{apex.x, apex.y};
      rings_.from[i] = left ? w.from : place;
      rings_.to[i] = left ? place : w.to;
      const float2 right = right_is_apex ? apex_ray : float2{w.rays.right_x, w.rays.right_y};
      const float2 other = left_is_apex ? apex_ray : float2{w.rays.left_x, w.rays.left_y};
      rings_.rays[i] = {right.x, right.y, other.x, other.y};
      rings_.reaches[i] = {right_is_apex ? apex.view.reach : w.rays.right_reach,
                           left_is_apex ? apex.view.reach : w.rays.left_reach};
      if constexpr (!All) {
        rings_.ways[i] = {right_is_apex ? apex.way : w.right_way, left_is_apex ? apex.way : w.left_way};
        rings_.most[i] = most;
      }
      rings_.edges[i] = left ? apex.left : apex.right;
      rings_.roots[i] = w.root;
      const auto here = static_cast<unsigned short>(slot);
      rings_.ends[i] = left ? make_ushort2(w.ends.x, here) : make_ushort2(here, w.ends.y);
    }
    (ring == 0 ? left_count_ : right_count_) = count + __popc(keeping);
    __syncwarp();
  }

  SADDLEBACK_STEP bool is_kept(int slot) const {
    const float reach = distance_of(static_cast<std::int32_t>(table_.arcs[slot] >> 32));
    return reach < distance_of(k_unreached_label) &&
           reach <= mesh_.slack * static_cast<double>(distance_of(table_.labels[slot])) && reach <= limit_;
  }

  /// Slots with labels up to one.
  SADDLEBACK_STEP int count_labels(std::int32_t most) const {
    int count = 0;
    for (int i = lane_; i < k_slots; i += 32) count += table_.labels[i] <= most;
    return warp_sum(count);
  }

  /// Lowers the radius of the disk to that of the k-th nearest vertex, as far as is known.
  SADDLEBACK_STEP bool bound_disk() {
    __syncwarp();
    const int wanted = mesh_.k + 1;  // a node is its own nearest
    std::int32_t low = -1, high = min(__float_as_int(limit_), k_unreached_label - 1);
    // The k-th label is at most the limit over k_disk_as_far, once there is one.
    int count = count_labels(high);
    if (count < wanted) return false;
    while (count != wanted && high - low > 1) {
      const std::int32_t middle = low + (high - low) / 2;
      const int there = count_labels(middle);
      if (there >= wanted) {
        high = middle;
        count = there;
      } else {
        low = middle;
      }
    }
    std::int32_t kth = 0;
    for (int i = lane_; i < k_slots; i += 32)
      if (table_.labels[i] <= high) kth = max(kth, table_.labels[i]);
    const float radius = distance_of(warp_max(kth)) * k_disk_as_far;
    if (!(radius < limit_)) return false;
    limit_ = radius;
    return true;
  }

  /// As DiskFinder::relax_bends: what bends make of the labels does not depend on the order in which they are told.
  SADDLEBACK_STEP void relax_bends() {
    if (!(limit_ < distance_of(k_unreached_label))) return;
    while (const int count = list_changed()) {
      for (int i = lane_ / 8; i < count; i += 4) tell_neighbours(table_.todo[i]);
      if (overflowed()) return;
    }
  }

  /// Takes the slots that are marked as changed into the list of those to do. \return how many
  SADDLEBACK_STEP int list_changed() {
    __syncwarp();
    int count = 0;
    for (int base = 0; base < k_slots / 32; base += 32) {
      const int at = base + lane_;
      std::uint32_t word = at < k_slots / 32 ? table_.changed[at] : 0;
      if (word != 0) table_.changed[at] = 0;
      int through = __popc(word);  // of the lanes up to this one
      for (int step = 1; step < 32; step *= 2) {
        const int before = __shfl_up_sync(k_warp, through, step);
        if (lane_ >= step) through += before;
      }
      int next = count + through - __popc(word);
      for (; word != 0; word &= word - 1)
        table_.todo[next++] = static_cast<std::uint16_t>(32 * at + __ffs(static_cast<int>(word)) - 1);
      count += __shfl_sync(k_warp, through, 31);
    }
    __syncwarp();
    return count;
  }

  /// By eight lanes.
  SADDLEBACK_STEP void tell_neighbours(int slot) {
    const std::int32_t label = table_.labels[slot];
    const auto node = static_cast<std::int32_t>(table_.keys[slot]);
    if (!(distance_of(label) < limit_) || ((label & 1) == 0 && mesh_.saddles[node] == 0)) return;
    const auto offer = [&](std::int32_t target, double length) {
      const int there = insert(target);
      if (there < 0) return;
      const std::int32_t bent = label_of((distance_of(label) + static_cast<float>(length)) * k_bend_longer, false);
      lower_label(there, bent, true);
    };
    const std::int32_t end = mesh_.first[node + 1];
    for (std::int32_t e = mesh_.first[node] + (lane_ & 7); e < end; e += 8) {
      const double length = mesh_.lengths[e];
      offer(mesh_.targets[e], length);
      const EdgeRecord& record = mesh_.records[e];
      if (record.left < 0) offer(record.apex, norm_of(record.a * length, record.b * length));
    }
  }

  const DeviceMesh& mesh_;
  Table& table_;
  Rings& rings_;
  Sighting* draft_;
  int draft_room_, lane_;
  std::int32_t node_ = 0;
  float limit_ = 0;                                        ///< of the disk
  int left_head_, right_head_, left_count_, right_count_;  ///< of the rings
  int arcs_ = 0, links_ = 0, generation_ = 0;
  bool overflow_ = false;
};

}  // namespace
}  // namespace saddleback
