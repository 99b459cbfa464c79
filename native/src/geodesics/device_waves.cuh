#pragma once
// Windows of a few sources, kept and advanced by the 32 lanes of a warp: the twin of DiskFinder, to the bit.
//
// As there, generations have no order but their own: all windows of one look at their apexes, the labels are lowered,
// then all are split. Most windows see no corner and light one side only, so that sides are what lanes are filled with
// when windows are split. Windows lie anywhere in their pool; what keeps the processor's order is lists of their
// places.

#include <cstdint>

#include "geodesics/device_edge_bound.cuh"
#include "geodesics/device_wave_memory.cuh"
#include "support/warp.cuh"

namespace saddleback {
namespace {

/// The sources of a warp: neighbours in the order of the nodes.
struct WarpSources {
  std::int32_t node;  ///< the first
  int count;
};

/// Sources from their first windows to the vertices that they see. `Seats` sources at most.
template <class Table, class Pool, int Seats>
class WarpWaves {
  static constexpr bool All = Pool::All;
  static constexpr int k_windows = Pool::Windows, k_lanes_per_seat = 32 / Seats;

 public:
  using Edges = EdgeDistances<Table::Slots>;
  /// `draft` has room for the sightings that make arcs.
  SADDLEBACK_STEP WarpWaves(const DeviceMesh& mesh, Table& table, Pool& pool, Edges* edges, Sighting* draft,
                            int draft_room)
      : mesh_(mesh),
        table_(table),
        pool_(pool),
        edges_(edges),
        disk_(mesh, table),
        draft_(draft),
        draft_room_(draft_room),
        lane_(threadIdx.x & 31),
        below_((1u << lane_) - 1) {}

  SADDLEBACK_STEP void begin(const WarpSources& sources) {
    sources_ = sources;
    arcs_ = generation_ = windows_ = 0;
    count_[0] = count_[1] = 0;
    overflow_ = false;
    for (int i = lane_; i < k_windows; i += 32) pool_.free[i] = static_cast<Place>(i);
    free_count_ = k_windows;
    disk_.clear();
    const int seat = lane_ / k_lanes_per_seat, first = lane_ % k_lanes_per_seat;
    const bool has_source = seat < sources.count;
    const std::int32_t node = sources.node + (has_source ? seat : 0);
    const std::int32_t e = mesh_.first[node], count = has_source ? mesh_.first[node + 1] - e : 0;
    if (count > RootEdge::k_most_edges) overflow_ = true;
    const bool at_centre = has_source && first == 0;
    const int centre = disk_.insert(at_centre, Key::pack(node, seat, mesh_.saddles[node] != 0));
    if (at_centre) disk_.lower(centre, label_of(0, false), false);
    for (int edge = first; __any_sync(k_warp, edge < count) && !overflowed(); edge += k_lanes_per_seat)
      add_edges(seat, edge, e + edge, edge < count);
    links_ = arcs_;
  }

  /// To the last generation. False when the memory did not do.
  SADDLEBACK_STEP bool run() {
    while (!overflowed()) {
      const int lefts = uniform(count_[0]), all = uniform(count_[0] + count_[1]);
      if (all == 0) break;
      windows_ += all;
      if (windows_ > k_most_windows / k_batch) overflow_ = true;  // the processor may stop there
      lights_ = 0;
      for (int base = 0; base < all; base += 32) sight(base, lefts, all);
      __syncwarp();
      if (overflowed()) break;
      bend();
      count_[0] = count_[1] = 0;
      const int lights = uniform(lights_);
      for (int base = 0; base < lights; base += 32) pass_on(base, lights);
    }
    if constexpr (All) {
      for (bool smaller = true; smaller && !overflowed();) {
        smaller = disk_.bound();
        disk_.relax_bends();
      }
    }
    return !overflowed();
  }

  SADDLEBACK_STEP const WarpSources& sources() const { return sources_; }
  SADDLEBACK_STEP const WarpDisk<Table, Seats>& disk() const { return disk_; }
  SADDLEBACK_STEP const Sighting* draft() const { return draft_; }
  SADDLEBACK_STEP int arcs() const { return arcs_; }
  SADDLEBACK_STEP int links() const { return links_; }

 private:
  using Place = typename Pool::Place;
  using Ray = WindowRay<All>;
  using Key = DiskKey<Seats>;

  SADDLEBACK_STEP bool overflowed() { return __any_sync(k_warp, overflow_ || disk_.overflowed()); }
  SADDLEBACK_STEP int rank(unsigned lanes) const { return __popc(lanes & below_); }

  SADDLEBACK_STEP void put_arc(int number, const Sighting& seen) { draft_[min(number, draft_room_ - 1)] = seen; }

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
    if (active) {
      const std::int32_t label = label_of(static_cast<float>(length), true);
      disk_.lower(to, label, true);
      put_arc(number, {{length, 0}, {0, 0}, 0, ~root, to, label});
      if (boundary) {
        const std::int32_t far = label_of(static_cast<float>(other), true);
        disk_.lower(apex, far, true);
        put_arc(number + 1, {{other, 0}, {0, 0}, 1, ~root, apex, far});
      }
    }
    const bool opens = active && record.right >= 0;
    const unsigned opening = __ballot_sync(k_warp, opens);
    const int opened = __popc(opening);
    if (opened > free_count_) {
      overflow_ = true;
    } else if (opens) {
      const int place = pool_.free[free_count_ - 1 - rank(opening)];
      pool_.order[count_[0] + rank(opening)] = static_cast<Place>(place);
      pool_.ends[0][place] = corner;
      pool_.ends[1][place] = {length, 0};
      pool_.rays[0][place] =
          ray_of(static_cast<float>(corner.x / other), static_cast<float>(corner.y / other), static_cast<float>(other));
      pool_.rays[1][place] = ray_of(1, 0, static_cast<float>(length));
      pool_.links[place] = {record.right, EndSlots::pack(apex, to), static_cast<std::uint32_t>(root),
                            distance_of(k_unreached_label)};
    }
    free_count_ -= opened;
    count_[0] += opened;
    count_arcs(__popc(actives) + __popc(boundaries));
    __syncwarp();
  }

  SADDLEBACK_STEP static std::uint32_t apex_key(const EdgeRecord& record, int seat) {
    return Key::pack(record.apex, seat, (record.clearances & k_saddle_bit) != 0);
  }

  /// Of a flank that is itself the way there.
  SADDLEBACK_STEP static Ray ray_of(float x, float y, float reach) {
    if constexpr (All) {
      return {x, y};
    } else {
      return {x, y, reach, reach};
    }
  }

  SADDLEBACK_STEP void count_arcs(int more) {
    arcs_ += more;
    if (arcs_ > draft_room_) overflow_ = true;
  }

  /// 32 windows of the generation look at their apexes, lower the labels, and list their sides that are lit. Lanes
  /// without a window do what the first does, and write nothing.
  SADDLEBACK_STEP void sight(int base, int lefts, int all) {
    const bool active = base + lane_ < all;
    const int p = active ? base + lane_ : base;
    const int place = pool_.order[p < lefts ? p : k_windows - 1 - (p - lefts)];
    const WindowLinks links = pool_.links[place];
    const EdgeRecord record = mesh_.records[links.edge];
    const double2 from = pool_.ends[0][place], to = pool_.ends[1][place];
    const Ray left = pool_.rays[0][place], right = pool_.rays[1][place];
    const auto root = static_cast<int>(links.root);
    const auto claim = disk_.claim(active, apex_key(record, RootEdge::seat(root)));
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
    const int slot = disk_.settle(claim);
    const std::int32_t label = label_of(view.reach, direct);
    __syncwarp();  // nobody looks at the first window any more
    if (active) {
      if constexpr (!All) pool_.ways[place] = way;
      pool_.links[place].root = links.root | static_cast<std::uint32_t>(slot) << RootEdge::k_bits;
      if (view.in_sight) disk_.lower(slot, label, !direct || (record.clearances & k_saddle_bit) != 0);
    }
    const bool makes = active & direct;
    const unsigned making = __ballot_sync(k_warp, makes);
    if (makes) put_arc(arcs_ + rank(making), {apex, from, links.edge, root, slot, label});
    count_arcs(__popc(making));
    const float tolerance = k_on_ray * view.reach;
    list_lights(active, place, active & (record.left >= 0) & (tolerance < view.to_left),
                active & (record.right >= 0) & (tolerance < view.from_right));
  }

  SADDLEBACK_STEP static double2 apex_of(const EdgeRecord& record, const double2& from, const double2& to) {
    const double along_x = to.x - from.x, along_y = to.y - from.y;
    return {from.x + (record.a * along_x - record.b * along_y), from.y + (record.a * along_y + record.b * along_x)};
  }

  SADDLEBACK_STEP void list_lights(bool active, int place, bool left, bool right) {
    const unsigned lefts = __ballot_sync(k_warp, left), rights = __ballot_sync(k_warp, right);
    const unsigned actives = __ballot_sync(k_warp, active), ended = actives & ~(lefts | rights);
    const int at = lights_ + rank(lefts) + rank(rights);
    lights_ += __popc(lefts) + __popc(rights);
    if (lights_ > Pool::Lights) {
      overflow_ = true;
      return;
    }
    if (left) pool_.lights[at] = static_cast<std::uint16_t>(place | (right ? 0 : Light::k_last));
    if (right) pool_.lights[at + (left ? 1 : 0)] = static_cast<std::uint16_t>(place | Light::k_right | Light::k_last);
    if ((ended >> lane_ & 1) != 0) pool_.free[free_count_ + rank(ended)] = static_cast<Place>(place);
    free_count_ += __popc(ended);
  }

  SADDLEBACK_STEP void bend() {
    if constexpr (All) {
      if (++generation_ % k_generations_per_bound != 0) return;
      disk_.bound();
      if (generation_ >= k_blind_generations && !disk_.is_bounded()) bound_by_edges();
      disk_.relax_bends();
    }
  }

  /// In creases fewer than k vertices are in sight: no radius would ever end the windows there.
  SADDLEBACK_STEP void bound_by_edges() {
    const float radius = radius_by_edges(mesh_.neighbours, mesh_.k, &table_, edges_);
    if (radius < 0) overflow_ = true;
    disk_.lower_radius(max(radius, 0.0f));
  }

  /// The light on 32 sides becomes windows of the next generation. Lanes without one do what the first does, and write
  /// nothing.
  SADDLEBACK_STEP void pass_on(int base, int lights) {
    const bool active = base + lane_ < lights;
    const int light = pool_.lights[active ? base + lane_ : base];
    const int place = light & Light::k_place, s = light / Light::k_right & 1;
    const WindowLinks links = pool_.links[place];
    const auto apex_slot = static_cast<int>(links.root >> RootEdge::k_bits);
    const EdgeRecord record = mesh_.records[links.edge];
    const double2 from = pool_.ends[0][place], to = pool_.ends[1][place], near = pool_.ends[s][place];
    const Ray near_ray = pool_.rays[s][place], far_ray = pool_.rays[1 - s][place];
    const float way = All ? 0 : pool_.ways[All ? 0 : place];
    const float near_label = distance_of(disk_.label(EndSlots::slot(links.ends, s)));
    const float far_label = distance_of(disk_.label(EndSlots::slot(links.ends, 1 - s)));
    const float apex_label = distance_of(disk_.label(apex_slot));
    const double2 apex = apex_of(record, from, to);
    // Right sides are seen in a mirror.
    const float flip = s == 0 ? 1 : -1;
    const float apex_x = static_cast<float>(apex.x), apex_y = flip * static_cast<float>(apex.y);
    const float from_x = static_cast<float>(from.x), from_y = flip * static_cast<float>(from.y);
    const float to_x = static_cast<float>(to.x), to_y = flip * static_cast<float>(to.y);
    const ApexView view = view_apex(apex_x, apex_y, {far_ray.x, flip * far_ray.y, near_ray.x, flip * near_ray.y, 0, 0});
    const float reach = view.reach;
    const bool cut = k_on_ray * reach < view.from_right;
    const Side side{active,
                    cut,
                    s == 0 ? from_x : to_x,
                    s == 0 ? from_y : to_y,
                    s == 0 ? to_x : from_x,
                    s == 0 ? to_y : from_y,
                    apex_x,
                    apex_y,
                    near_ray.x,
                    flip * near_ray.y,
                    far_ray.x,
                    flip * far_ray.y,
                    view.to_left,
                    view.from_right,
                    near_label,
                    far_label,
                    apex_label};
    const Child child = look_at(side);
    const ApexRay ray = ray_to({apex_x, apex_y, reach, 0, 0, false, false});
    Ray last_ray = far_ray;  // where the light ends
    last_ray.x = cut ? ray.x : far_ray.x;
    last_ray.y = cut ? flip * ray.y : far_ray.y;
    float most = disk_.radius();
    if constexpr (!All) {
      most = links.most;
      if (__any_sync(k_warp, cut)) {
        const float bound = bound_child(side, ray, {reach, way}, {near_ray.reach, near_ray.way}, mesh_.excess, most);
        most = cut ? bound : most;
      }
      last_ray.reach = cut ? reach : far_ray.reach;
      last_ray.way = cut ? way : far_ray.way;
    }
    const std::uint32_t clearance =
        s == 0 ? record.clearances & k_upper_half : (record.clearances & ~k_saddle_bit) << 16;
    const bool keep = child.useful & is_within(child, most, __int_as_float(static_cast<std::int32_t>(clearance)));

    const int heir = settle(active, keep, (light & Light::k_last) != 0, place);
    const int number = count_children(keep, s);
    if (keep & !overflow_) {
      pool_.order[number] = static_cast<Place>(heir);
      pool_.ends[s][heir] = near;
      pool_.ends[1 - s][heir] = apex;
      pool_.rays[s][heir] = near_ray;
      pool_.rays[1 - s][heir] = last_ray;
      pool_.links[heir] = {s == 0 ? record.left : record.right, EndSlots::replaced(links.ends, 1 - s, apex_slot),
                           links.root & ((1u << RootEdge::k_bits) - 1), most};
    }
    __syncwarp();
  }

  /// Where a child goes: into its parent's place, if nobody looks there any more, or into a free one.
  SADDLEBACK_STEP int settle(bool active, bool keep, bool last, int place) {
    const unsigned taking = __ballot_sync(k_warp, keep & !last), giving = __ballot_sync(k_warp, active & last & !keep);
    const int free = pool_.free[max(0, free_count_ - 1 - rank(taking))];
    __syncwarp();  // nobody looks at the windows, nor takes of what is free, any more
    free_count_ -= __popc(taking);
    if (free_count_ < 0) overflow_ = true;
    free_count_ = max(0, free_count_);
    if ((giving >> lane_ & 1) != 0) pool_.free[free_count_ + rank(giving)] = static_cast<Place>(place);
    free_count_ += __popc(giving);
    return last ? place : free;
  }

  /// Where a child is listed.
  SADDLEBACK_STEP int count_children(bool keep, int side) {
    const unsigned all = __ballot_sync(k_warp, keep), rights = __ballot_sync(k_warp, keep & (side == 1));
    const unsigned lefts = all & ~rights;
    const int number = side == 0 ? count_[0] + rank(lefts) : k_windows - 1 - (count_[1] + rank(rights));
    count_[0] += __popc(lefts);
    count_[1] += __popc(rights);
    return number;
  }

  const DeviceMesh& mesh_;
  Table& table_;
  Pool& pool_;
  Edges* edges_;  ///< where disks end by count
  WarpDisk<Table, Seats> disk_;
  Sighting* draft_;
  int draft_room_, lane_;
  unsigned below_;  ///< lanes before this one
  WarpSources sources_{0, 0};
  int count_[2] = {0, 0};  ///< windows of the generation that is being made, behind left and right sides
  int free_count_ = 0, lights_ = 0;
  int arcs_ = 0, links_ = 0, generation_ = 0, windows_ = 0;
  bool overflow_ = false;
};

}  // namespace
}  // namespace saddleback
