#pragma once
// Windows of a few sources, kept and advanced by the 32 lanes of a warp: the CUDA counterpart of GeodesicDisks, to the
// bit.
//
// As there, generations have no order but their own: all windows of one look at their apexes, the labels are lowered,
// then all are split. Where labels do not count yet (k_free_generations) not even that matters: 32 windows are sighted
// and 32 cones split, whichever wait. Most windows see no corner and cover one side only, so that sides are what lanes
// are filled with when windows are split. In what order a generation is taken matters to nothing but which of two
// sightings is the first: see device_sighting_order.cuh.

#include <cstdint>

#include "geodesics/cuda/device_edge_bound.cuh"
#include "geodesics/cuda/device_window_memory.cuh"
#include "geodesics/unfolding/unfolded_corner.h"
#include "support/cuda/warp.cuh"

namespace saddleback {
namespace {

/// The sources of a warp: neighbors in the order of the nodes.
struct WarpSources {
  std::int32_t node;  ///< the first
  int count;
};

/// Gives windows their numbers in the processor's order, of `count` from the one at `begin` on, in place of their
/// turns. Not in line: few sources have so many generations. \return how many bits the numbers have
template <class Pool>
__device__ __noinline__ int renumber(Pool* pool, int begin, int count) {
  const auto links_of = [&](int number) -> typename Pool::Links& {
    const int place = begin + number;
    return pool->links[place < Pool::Windows ? place : place - Pool::Windows];
  };
  const auto order_of = [&](const typename Pool::Links& links) {
    return order_in_generation(links.turns(), RootEdge::edge(links.root()));
  };
  const int lane = static_cast<int>(threadIdx.x & 31);
  __syncwarp();
  for (int i = lane; i < count; i += 32) {
    const std::uint32_t own = order_of(links_of(i));
    int before = 0;
    for (int j = 0; j < count; ++j) before += order_of(links_of(j)) < own ? 1 : 0;
    pool->cones[i] = static_cast<std::uint16_t>(before);
  }
  __syncwarp();
  const int bits = 32 - __clz(max(count - 1, 0));
  for (int i = lane; i < count; i += 32) links_of(i).set_turns(pool->cones[i], bits);
  __syncwarp();
  return bits;
}

/// Sources from their first windows to the vertices that they see. `Seats` sources at most.
template <class Table, class Pool, int Seats>
class WarpWaves {
  static constexpr bool All = Pool::All;
  static constexpr int k_windows = Pool::Windows, k_lanes_per_seat = 32 / Seats;
  static constexpr int k_draft_room = Table::Draft;

 public:
  using Edges = EdgeDistances<Table::Slots>;
  SADDLEBACK_STEP WarpWaves(const DeviceMesh& mesh, Table& table, Pool& pool, Edges* edges, Sighting* draft)
      : mesh_(mesh),
        table_(table),
        pool_(pool),
        edges_(edges),
        disk_(mesh, table),
        draft_(reinterpret_cast<char*>(draft)),
        lane_(threadIdx.x & 31),
        below_((1u << lane_) - 1) {
    asm("" : "+l"(draft_));  // lest it be computed again for each arc
    __builtin_assume(__isGlobal(draft_));
  }

  SADDLEBACK_STEP void begin(const WarpSources& sources) {
    sources_ = sources;
    arcs_ = generation_ = turns_ = windows_ = 0;
    end_ = count_ = first_cone_ = cones_ = 0;
    overflow_ = 0;
    disk_.clear();
    const int seat = lane_ / k_lanes_per_seat, first = lane_ % k_lanes_per_seat;
    const bool has_source = seat < sources.count;
    const std::int32_t node = sources.node + (has_source ? seat : 0);
    const std::int32_t e = mesh_.first[node], count = has_source ? mesh_.first[node + 1] - e : 0;
    if (count > Links::k_most_edges) overflow_ = 1;
    const bool at_center = has_source && first == 0;
    const int center = disk_.insert(at_center, Key::pack(node, seat, mesh_.saddles[node] != 0));
    disk_.lower(at_center, center, label_of(0, false), false);
    for (int edge = first; __any_sync(k_warp, edge < count) && !overflowed(); edge += k_lanes_per_seat)
      add_edges(seat, edge, e + edge, edge < count);
    links_ = arcs_before_ = arcs_;
    is_filtered_ = All;
    set_free(Pool::is_dense);
    if (!All) count_windows(Pool::is_dense ? k_free_generations * k_windows : count_);  // or fewer
  }

  /// Runs to the last generation. False when the memory did not do.
  SADDLEBACK_STEP bool run() {
    if constexpr (All) return run_to_radius();
    if (overflowed()) return false;
    int next = 0, waiting = count_;  // windows to be sighted, of a generation or, as long as they are free, of two
    count_ = 0;
    while (true) {
      // Free, what fills the lanes comes first.
      while (waiting > 0 && cones_ <= most_cones_ && (waiting >= 32 || cones_ - patience_ < waiting)) {
        const int taken = min(32, waiting);
        sight(next, taken);
        next = in_ring(next + taken);
        waiting -= taken;
        __syncwarp();
      }
      if (cones_ == 0) {
        waiting = begin_generation(next);
        if (waiting == 0 || overflowed()) break;
        continue;
      }
      if (has_no_room()) break;
      const int taken = min(32, cones_);
      waiting += pass_on(taken, taken < cones_ ? window_of_cone(first_cone_ + taken) : next);
      first_cone_ += taken;
      cones_ -= taken;
      __syncwarp();
    }
    return !overflowed();
  }

  SADDLEBACK_STEP const WarpSources& sources() const { return sources_; }
  SADDLEBACK_STEP const WarpDisk<Table, Seats>& disk() const { return disk_; }
  SADDLEBACK_STEP const Sighting* draft() const {
    __builtin_assume(__isGlobal(draft_));
    return reinterpret_cast<const Sighting*>(draft_);
  }
  SADDLEBACK_STEP int arcs() const { return arcs_; }
  SADDLEBACK_STEP int links() const { return links_; }

 private:
  using Links = typename Pool::Links;
  using Ray = WindowRay<All>;
  using Key = DiskKey<Seats>;

  SADDLEBACK_STEP bool has_no_room() {
    return __any_sync(k_warp, (cones_ > Pool::Cones) | (overflow_ != 0) | disk_.overflowed()) != 0;
  }
  SADDLEBACK_STEP bool overflowed() { return has_no_room() || arcs_ > k_draft_room; }
  SADDLEBACK_STEP int rank(unsigned lanes) const { return __popc(lanes & below_); }
  SADDLEBACK_STEP static int in_ring(int number) {
    const auto place = static_cast<unsigned>(number);
    return static_cast<int>(min(place, place - k_windows));
  }
  SADDLEBACK_STEP static int cone_place(int number) { return Pool::is_dense ? number & (Pool::Cones - 1) : number; }
  SADDLEBACK_STEP int window_of_cone(int number) const { return pool_.cones[cone_place(number)] & Cone::k_number; }

  /// Begins the next generation when no window and no cone waits any more: those that count_ counts, from a place on,
  /// come next, all of one generation. \return how many
  SADDLEBACK_STEP int begin_generation(int place) {
    const int all = count_;
    const bool was_free = stop_ > 0;
    if (!was_free) count_windows(all);
    count_ = first_cone_ = 0;
    arcs_before_ = arcs_;
    generation_ += was_free ? stop_ - turns_ : 1;
    turns_ = was_free ? stop_ : turns_ + 1;
    if (turns_ == k_most_turns) turns_ = renumber(&pool_, place, all);
    is_filtered_ = generation_ >= k_free_generations;
    set_free(Pool::is_dense && !is_filtered_);
    return all;
  }

  /// Says whether windows may be taken in any order.
  SADDLEBACK_STEP void set_free(bool free) {
    constexpr int k_all = 1 << 20;
    stop_ = free ? min(k_most_turns, turns_ + k_free_generations - generation_) : 0;
    most_cones_ = free ? 31 : k_all;
    patience_ = free ? 0 : k_all;
  }

  SADDLEBACK_STEP void count_windows(int more) {
    windows_ += more;
    if (windows_ > k_most_windows / k_batch) overflow_ = 1;  // the processor may stop there
  }

  /// Runs until the disk becomes no smaller.
  SADDLEBACK_STEP bool run_to_radius() {
    for (int begin = 0; !overflowed();) {
      const int all = uniform(count_), behind = in_ring(begin + all);
      count_windows(all);
      arcs_before_ = arcs_;
      first_cone_ = cones_ = 0;
      for (int base = 0; base < all; base += 32) sight(in_ring(begin + base), min(32, all - base));
      __syncwarp();
      if (overflowed()) break;
      const bool smaller = bend(all == 0);
      if (all == 0 && !smaller) break;
      const int cones = uniform(cones_);
      for (; first_cone_ < cones; first_cone_ += 32)
        pass_on(min(32, cones - first_cone_), first_cone_ + 32 < cones ? window_of_cone(first_cone_ + 32) : behind);
      __syncwarp();
      begin = behind;
      count_ = in_ring(end_ - begin + k_windows);
      if (++turns_ == k_most_turns) turns_ = renumber(&pool_, begin, count_);
    }
    return !overflowed();
  }

  SADDLEBACK_STEP void put_arc(int number, const Sighting& seen) {
    const auto at = static_cast<std::uint32_t>(min(number, k_draft_room - 1)) * std::uint64_t{sizeof seen};
    *reinterpret_cast<Sighting*>(draft_ + at) = seen;
  }

  /// Links and first windows of the sources' edges, one a lane.
  SADDLEBACK_STEP void add_edges(int seat, int edge, std::int32_t e, bool active) {
    const EdgeRecord record = mesh_.records[active ? e : 0];
    const double length = mesh_.lengths[active ? e : 0];
    const std::int32_t target = mesh_.targets[active ? e : 0];
    const int to = disk_.insert(active, Key::pack(target, seat, mesh_.saddles[target] != 0));
    const int apex = disk_.insert(active, apex_key(record, seat));
    const bool boundary = active && record.left < 0;
    const unsigned actives = __ballot_sync(k_warp, active), boundaries = __ballot_sync(k_warp, boundary);
    const int number = arcs_ + rank(actives) + rank(boundaries), root = RootEdge::pack(seat, edge);
    const double2 corner{record.a * length, record.b * length};
    const double other = norm_of(corner.x, corner.y);
    const std::int32_t near_label = label_of(static_cast<float>(length), true);
    const std::int32_t far_label = label_of(static_cast<float>(other), true);
    disk_.lower(active, to, near_label, true);
    disk_.lower(boundary, apex, far_label, true);
    if (active) put_arc(number, {{length, 0}, {0, 0}, 0, 0, Sighting::pack(root, to), near_label});
    if (boundary) put_arc(number + 1, {{other, 0}, {0, 0}, 1, 0, Sighting::pack(root, apex), far_label});
    const bool opens = active && record.right >= 0;
    if (active && is_too_thin(record.a, record.b)) overflow_ = 1;  // the processor looks in double precision
    if (opens && corner.x < 0) {
      const double2 beyond = apex_of(mesh_.records[record.right], corner, {length, 0});
      if (is_on_both_rays(length, 0, corner.x, corner.y, beyond.x, beyond.y)) overflow_ = 1;
    }
    const unsigned opening = __ballot_sync(k_warp, opens);
    const int opened = __popc(opening);
    if (count_ + opened >= k_windows) {
      overflow_ = 1;
    } else if (opens) {
      const int place = count_ + rank(opening);
      pool_.ends[0][place] = corner;
      pool_.ends[1][place] = {length, 0};
      pool_.rays[0][place] =
          ray_of(static_cast<float>(corner.x / other), static_cast<float>(corner.y / other), static_cast<float>(other));
      pool_.rays[1][place] = ray_of(1, 0, static_cast<float>(length));
      if constexpr (!All) pool_.served[0][place] = pool_.served[1][place] = 0;
      Links links = Links::first(record.right, apex, to, root);
      set_most(links, place, distance_of(k_unreached_label));
      pool_.links[place] = links;
    }
    end_ = count_ += opened;
    arcs_ += __popc(actives) + __popc(boundaries);
    __syncwarp();
  }

  SADDLEBACK_STEP static std::uint32_t apex_key(const EdgeRecord& record, int seat) {
    return Key::pack(record.apex, seat, (record.clearances & k_saddle_bit) != 0);
  }

  /// Returns the ray of a flank that is itself the way there.
  SADDLEBACK_STEP static Ray ray_of(float x, float y, float reach) {
    if constexpr (All) {
      return {x, y};
    } else {
      return {x, y, reach, reach};
    }
  }

  /// The `taken` windows from a place on look at their apexes, lower the labels, and list their sides that cones cover.
  /// Lanes without a window do what the last does, and write nothing.
  SADDLEBACK_STEP void sight(int first, int taken) {
    const bool active = lane_ < taken;
    const int place = in_ring(first + min(lane_, taken - 1));
    const Links links = pool_.links[place];
    const EdgeRecord record = mesh_.records[links.edge];
    const double2 from = pool_.ends[0][place], to = pool_.ends[1][place];
    const Ray left = pool_.rays[0][place], right = pool_.rays[1][place];
    const int root = links.root();
    const auto probe = disk_.probe(active, apex_key(record, Seats > 1 ? RootEdge::seat(root) : 0));
    const double2 apex = apex_of(record, from, to);
    Rays rays{right.x, right.y, left.x, left.y, 0, 0};
    if constexpr (!All) {
      rays.right_reach = right.reach;
      rays.left_reach = left.reach;
    }
    const ApexView view = view_apex(static_cast<float>(apex.x), static_cast<float>(apex.y), rays);
    bool direct = view.inside;
    float way = 0;
    if constexpr (!All) {
      const float by_flank = way_by_flank(view, rays, right.way, left.way, mesh_.detour);
      direct = direct & (mesh_.detour * view.reach < by_flank);
      way = direct ? view.reach : by_flank;
    }
    const int slot = disk_.settle(probe);
    const std::int32_t label = label_of(view.reach, direct);
    __syncwarp();  // nobody looks at the last window any more
    if (active) {
      links.note_apex(pool_.links[place], slot);
      if constexpr (!All) {
        pool_.apexes[place] = apex;
        pool_.ways[place] = way;
      }
    }
    disk_.lower(active & view.in_sight, slot, label, !direct | ((record.clearances & k_saddle_bit) != 0));
    const bool makes = active & direct;
    const unsigned making = __ballot_sync(k_warp, makes);
    if (makes) {
      const int number = arcs_ + rank(making);
      int at = slot;
      const std::int32_t mark = number == arcs_before_ ? Sighting::k_begins : 0;
      if constexpr (Pool::is_dense) at = Table::Sighted::pack(slot, links.generation() + 1);
      put_arc(number, {apex, from, links.edge, links.turns(), Sighting::pack(root, at), label | mark});
    }
    arcs_ += __popc(making);
    float from_right = view.from_right, to_left = view.to_left;
    if constexpr (!All) {
      const Rays cone = turn_inwards(rays, pool_.served[1][place], pool_.served[0][place]);
      from_right = cross(cone.right_x, cone.right_y, view.x, view.y);
      to_left = cross(view.x, view.y, cone.left_x, cone.left_y);
    }
    const float tolerance = k_on_ray * view.reach;
    list_cones(place, active && record.left >= 0 && tolerance < to_left,
               active && record.right >= 0 && tolerance < from_right);
  }

  SADDLEBACK_STEP static double2 apex_of(const EdgeRecord& record, const double2& from, const double2& to) {
    const double along_x = to.x - from.x, along_y = to.y - from.y;
    return {from.x + (record.a * along_x - record.b * along_y), from.y + (record.a * along_y + record.b * along_x)};
  }

  SADDLEBACK_STEP float most_of(const Links& links, int place) const {
    if constexpr (Pool::is_dense) {
      return links.most;
    } else if constexpr (All) {
      return 0;
    } else {
      return pool_.most[place];
    }
  }
  SADDLEBACK_STEP void set_most(Links& links, int place, float most) {
    if constexpr (Pool::is_dense) {
      links.most = most;
    } else if constexpr (!All) {
      pool_.most[place] = most;
    }
  }

  SADDLEBACK_STEP void list_cones(int place, bool left, bool right) {
    const unsigned lefts = __ballot_sync(k_warp, left), rights = __ballot_sync(k_warp, right);
    const int at = first_cone_ + cones_ + rank(lefts) + rank(rights);
    cones_ += __popc(lefts) + __popc(rights);
    const bool fits = Pool::is_dense || cones_ <= Pool::Cones;
    if (fits && left) pool_.cones[cone_place(at)] = static_cast<std::uint16_t>(place);
    if (fits && right) pool_.cones[cone_place(at + (left ? 1 : 0))] = static_cast<std::uint16_t>(place | Cone::k_right);
  }

  /// Every few generations, and when no window is left until the disk becomes no smaller. \return whether it did
  SADDLEBACK_STEP bool bend(bool is_last) {
    bool smaller = false;
    if constexpr (All) {
      if (!is_last && ++generation_ % k_generations_per_bound != k_first_bound) return false;
      smaller = disk_.bound();
      if (!is_last && generation_ >= k_blind_generations && !disk_.is_bounded()) bound_by_edges();
      disk_.relax_bends();
    }
    return smaller;
  }

  /// Bounds the disk by edges: in creases fewer than k vertices are in sight: no radius would ever end the windows
  /// there.
  SADDLEBACK_STEP void bound_by_edges() {
    const float radius = radius_by_edges(mesh_.neighbors, mesh_.k, &table_, edges_);
    if (radius < 0) overflow_ = 1;
    disk_.lower_radius(max(radius, 0.0f));
  }

  /// The cone on `taken` sides becomes windows of the next generation. Lanes without one do what the last does, and
  /// write nothing. Windows from the `oldest` on are still needed. \return how many may be sighted; others are counted
  SADDLEBACK_STEP int pass_on(int taken, int oldest) {
    const bool active = lane_ < taken;
    const int cone = pool_.cones[cone_place(first_cone_ + min(lane_, taken - 1))];
    const int place = cone & Cone::k_number, s = cone / Cone::k_right & 1;
    const Links links = pool_.links[place];
    const EdgeRecord record = mesh_.records[links.edge];
    const double2 near = pool_.ends[s][place], far = pool_.ends[1 - s][place];
    const Ray near_ray = pool_.rays[s][place], far_ray = pool_.rays[1 - s][place];
    const float way = All ? 0 : pool_.ways[All ? 0 : place];
    double2 apex;
    if constexpr (All) {
      apex = apex_of(record, s == 0 ? near : far, s == 0 ? far : near);  // to keep it takes longer
    } else {
      apex = pool_.apexes[place];
    }
    // Right sides are seen in a mirror.
    const float flip = s == 0 ? 1.0f : -1.0f;
    const float apex_x = static_cast<float>(apex.x), apex_y = flip * static_cast<float>(apex.y);
    const Rays rays{far_ray.x, flip * far_ray.y, near_ray.x, flip * near_ray.y, 0, 0};
    Rays beam = rays;
    if constexpr (!All) beam = turn_inwards(rays, pool_.served[1 - s][place], pool_.served[s][place]);
    const ApexView view = view_apex(apex_x, apex_y, rays);
    const float tolerance = k_on_ray * view.reach, from_right = cross(beam.right_x, beam.right_y, apex_x, apex_y);
    const bool cut = tolerance < view.from_right;
    const Side side{active,
                    tolerance < from_right,
                    static_cast<float>(near.x),
                    flip * static_cast<float>(near.y),
                    static_cast<float>(far.x),
                    flip * static_cast<float>(far.y),
                    apex_x,
                    apex_y,
                    beam.left_x,
                    beam.left_y,
                    beam.right_x,
                    beam.right_y,
                    cross(apex_x, apex_y, beam.left_x, beam.left_y),
                    from_right};
    Child child = look_at(side);
    if (is_filtered_) {
      const CornerLabels labels{distance_of(disk_.label(links.end(s))), distance_of(disk_.label(links.end(1 - s))),
                                distance_of(disk_.label(links.apex()))};
      child.useful = child.useful & !is_served_by_corner(side, child, labels);
    }
    const float clearance = __int_as_float(static_cast<std::int32_t>(
        s == 0 ? record.clearances & k_upper_half : (record.clearances & ~k_saddle_bit) << 16));
    const ChildWindow child_window =
        look_behind(child, cut, view, near_ray, far_ray, flip, way, clearance, most_of(links, place));
    Ray last_ray = far_ray;  // where the cone ends
    last_ray.x = child_window.far.x;
    last_ray.y = flip * child_window.far.y;
    if constexpr (!All) {
      last_ray.reach = child_window.far.reach;
      last_ray.way = child_window.far.way;
    }
    const bool keep = child_window.useful;

    const unsigned keeping = __ballot_sync(k_warp, keep);
    const bool fits = in_ring(end_ - oldest + k_windows) + __popc(keeping) < k_windows;
    const int kept = fits ? __popc(keeping) : 0;  // lest what was never written be sighted
    if (!fits) overflow_ = 1;
    __syncwarp();  // nobody looks at the windows any more
    if (keep && fits) {
      const int there = in_ring(end_ + rank(keeping));
      pool_.ends[s][there] = near;
      pool_.ends[1 - s][there] = apex;
      pool_.rays[s][there] = near_ray;
      pool_.rays[1 - s][there] = last_ray;
      if constexpr (!All) {
        pool_.served[s][there] = child_window.near_served;
        pool_.served[1 - s][there] = child_window.far_served;
      }
      const std::int32_t behind = s == 0 ? record.left : record.right;
      Links child_links = links.child(behind, s, turns_);
      set_most(child_links, there, child_window.most);
      pool_.links[there] = child_links;
    }
    end_ = in_ring(end_ + kept);
    if constexpr (Pool::is_dense) {
      const bool is_last = links.generation() >= stop_ - 1;
      const int others = __popc(__ballot_sync(k_warp, keep & fits & is_last));
      count_ += others;
      return kept - others;
    } else {
      if (!All) count_ += kept;
      return 0;
    }
  }

  /// Returns what becomes of the cone on a side, in its words.
  SADDLEBACK_STEP ChildWindow look_behind(const Child& child, bool cut, const ApexView& apex, const Ray& near,
                                          const Ray& far, float flip, float way, float clearance, float most) const {
    const Flank flank = flank_at(apex, way);
    if constexpr (All) {
      return child_in_disk(child, cut, {far.x, flip * far.y, 0, 0}, flank, clearance, disk_.radius());
    } else {
      return child_behind(child, cut, {near.x, flip * near.y, near.reach, near.way},
                          {far.x, flip * far.y, far.reach, far.way}, flank, clearance, most, mesh_.excess,
                          mesh_.per_detour);
    }
  }

  const DeviceMesh& mesh_;
  Table& table_;
  Pool& pool_;
  Edges* edges_;  ///< where disks end by count
  WarpDisk<Table, Seats> disk_;
  char* draft_;  ///< Sightings
  int lane_;
  unsigned below_;  ///< lanes before this one
  WarpSources sources_{0, 0};
  int end_ = 0;    ///< place behind all windows
  int count_ = 0;  ///< windows that have to wait until all others are done
  int first_cone_ = 0, cones_ = 0;
  int stop_ = 0;              ///< windows of so many turns wait, others are free; 0: none is
  int most_cones_ = 0;        ///< that wait while windows are sighted
  int patience_ = 0;          ///< by how many they may be more than the windows that wait
  bool is_filtered_ = false;  ///< whether labels count
  int turns_ = 0;             ///< bits of the windows' turns
  int arcs_ = 0, links_ = 0, generation_ = 0, windows_ = 0;
  int arcs_before_ = 0;  ///< this generation, or these
  int overflow_ = 0;     ///< whether there is too little room
};

}  // namespace
}  // namespace saddleback
