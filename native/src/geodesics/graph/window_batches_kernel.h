// The kernel of window_batches.h, included by one source an instruction set, which defines `Simd` (see
// support/simd_*.h) and SADDLEBACK_WAVE_KERNEL.

#include "geodesics/graph/window_batches.h"

#define SADDLEBACK_STEP inline
#include "geodesics/graph/window_batches_step.h"

namespace saddleback {
namespace {

Rays load_rays(const WindowRows& w, int i) {
  return {Simd::load(w.right_x + i), Simd::load(w.right_y + i),     Simd::load(w.left_x + i),
          Simd::load(w.left_y + i),  Simd::load(w.right_reach + i), Simd::load(w.left_reach + i)};
}

template <bool All>
int sight(const WaveScene& scene, const WindowRows& w, int count, const ApexRows& apexes, const SightingRows& seen,
          int sightings) {
  const Ints lane_mask = Simd::fill_int(k_batch - 1);
  for (int i = 0; i < count; i += Simd::width) {
    Doubles a{}, b{};
    Ints left{}, right{}, apex{}, clearances{};
    Simd::load_records(scene.edges, w.edge + i, a, b, left, right, apex, clearances);
    const Doubles from_x = Simd::load(w.from_x + i), from_y = Simd::load(w.from_y + i);
    const Doubles along_x = Simd::load(w.to_x + i) - from_x, along_y = Simd::load(w.to_y + i) - from_y;
    const Doubles x = from_x + (a * along_x - b * along_y), y = from_y + (a * along_y + b * along_x);
    const Ints lane = Simd::load(w.edge + i) & lane_mask;
    const Ints slot = (apex << k_batch_bits) + lane;
    Simd::store(apexes.x + i, x);
    Simd::store(apexes.y + i, y);
    Simd::store(apexes.left + i, (left << k_batch_bits) + lane);
    Simd::store(apexes.right + i, (right << k_batch_bits) + lane);
    Simd::store(apexes.slot + i, slot);
    Simd::store(apexes.clearances + i, clearances);

    const Rays rays = load_rays(w, i);
    const ApexView view = view_apex(Simd::narrow(x), Simd::narrow(y), rays);
    Simd::store(apexes.reach + i, view.reach);
    Simd::store(apexes.from_right + i, view.from_right);
    Simd::store(apexes.to_left + i, view.to_left);
    Mask direct = view.inside, in_sight = view.in_sight;
    const Ints bits = Simd::bits_of(view.reach) & Simd::fill_int(~1);
    if constexpr (!All) {
      // Beyond the limit nothing is wanted: half of what windows about small cells see.
      in_sight = in_sight & !(Simd::look_up_lane(scene.limits, Simd::load(w.edge + i)) < Simd::floats_of(bits));
      const Floats detour = Simd::fill(scene.detour);
      const Floats way = way_by_flank(view, rays, Simd::load(w.right_way + i), Simd::load(w.left_way + i), detour);
      direct = direct & (detour * view.reach < way);
      Simd::store(apexes.way + i, Simd::pick(direct, view.reach, way));
    }
    const auto packing = Simd::packing(Simd::first(count - i) & in_sight);
    packing.store(seen.slot + sightings, slot);
    packing.store(seen.label + sightings, Simd::pick(direct, bits, bits | Simd::fill_int(1)));
    packing.store(seen.x + sightings, x);
    packing.store(seen.y + sightings, y);
    packing.store(seen.back_x + sightings, Simd::narrow(from_x - x));
    packing.store(seen.back_y + sightings, Simd::narrow(from_y - y));
    if (seen.from_x) {
      packing.store(seen.from_x + sightings, from_x);
      packing.store(seen.from_y + sightings, from_y);
    }
    packing.store(seen.edge + sightings, Simd::load(w.edge + i));
    packing.store(seen.root + sightings, Simd::load(w.root + i));
    sightings += packing.count();
  }
  return sightings;
}

/// The corners of a window's face, and what is known of them.
struct SplitFace {
  Doubles from_x, from_y, to_x, to_y, apex_x, apex_y;
  Ints from, to, apex;  ///< slots
};

/// Appends the child_windows of use behind left sides or, with `IsRight`, right ones; their flanks as they are, not
/// mirrored.
template <bool All, bool IsRight>
int append_children(const WindowRows& to, int count, const SplitFace& face, const Flank& near,
                    const ChildWindow& child_window, Ints edge, Ints root) {
  if (!Simd::any(child_window.useful)) return count;
  const auto packing = Simd::packing(child_window.useful);
  const Flank &right = IsRight ? near : child_window.far, &left = IsRight ? child_window.far : near;
  packing.store(to.from_x + count, IsRight ? face.apex_x : face.from_x);
  packing.store(to.from_y + count, IsRight ? face.apex_y : face.from_y);
  packing.store(to.to_x + count, IsRight ? face.to_x : face.apex_x);
  packing.store(to.to_y + count, IsRight ? face.to_y : face.apex_y);
  packing.store(to.right_x + count, right.x);
  packing.store(to.right_y + count, right.y);
  packing.store(to.left_x + count, left.x);
  packing.store(to.left_y + count, left.y);
  if constexpr (!All) {
    packing.store(to.right_reach + count, right.reach);
    packing.store(to.left_reach + count, left.reach);
    packing.store(to.right_way + count, right.way);
    packing.store(to.left_way + count, left.way);
    packing.store(to.right_served + count, IsRight ? child_window.near_served : child_window.far_served);
    packing.store(to.left_served + count, IsRight ? child_window.far_served : child_window.near_served);
  }
  packing.store(to.most + count, child_window.most);
  packing.store(to.edge + count, edge);
  packing.store(to.from + count, IsRight ? face.apex : face.from);
  packing.store(to.to + count, IsRight ? face.to : face.apex);
  packing.store(to.root + count, root);
  return count + packing.count();
}

template <bool All, bool Filtered>
void split(const WaveScene& scene, const WindowRows& w, int count, const ApexRows& apexes, const WindowRows& lefts,
           int* left_count, const WindowRows& rights, int* right_count) {
  for (int i = 0; i < count; i += Simd::width) {
    const Ints left_edge = Simd::load(apexes.left + i), right_edge = Simd::load(apexes.right + i);
    const Mask active = Simd::first(count - i);
    const SplitFace corners{Simd::load(w.from_x + i), Simd::load(w.from_y + i), Simd::load(w.to_x + i),
                            Simd::load(w.to_y + i),   Simd::load(apexes.x + i), Simd::load(apexes.y + i),
                            Simd::load(w.from + i),   Simd::load(w.to + i),     Simd::load(apexes.slot + i)};
    const Rays rays = load_rays(w, i);
    const FacePlaces face{Simd::narrow(corners.from_x), Simd::narrow(corners.from_y), Simd::narrow(corners.to_x),
                          Simd::narrow(corners.to_y)};
    const ApexView apex{Simd::narrow(corners.apex_x),
                        Simd::narrow(corners.apex_y),
                        Simd::load(apexes.reach + i),
                        Simd::load(apexes.from_right + i),
                        Simd::load(apexes.to_left + i),
                        {},
                        {}};
    Rays cone = rays;  // without what the flanks serve
    ApexView beam = apex;
    if constexpr (!All) {
      cone = turn_inwards(rays, Simd::load(w.right_served + i), Simd::load(w.left_served + i));
      beam.from_right = cross(cone.right_x, cone.right_y, apex.x, apex.y);
      beam.to_left = cross(apex.x, apex.y, cone.left_x, cone.left_y);
    }
    const Side to_left = left_side(face, beam, cone, active & (!Simd::negative(left_edge)));
    const Side to_right =
        left_side(mirrored(face), mirrored(beam), mirrored(cone), active & (!Simd::negative(right_edge)));
    Child left = look_at(to_left), right = look_at(to_right);
    if constexpr (Filtered) {
      const Floats from_label = Simd::look_up(scene.labels, w.from + i),
                   to_label = Simd::look_up(scene.labels, w.to + i);
      const Floats apex_label = Simd::look_up(scene.labels, apexes.slot + i);
      left.useful = left.useful & !is_served_by_corner(to_left, left, {from_label, to_label, apex_label});
      right.useful = right.useful & !is_served_by_corner(to_right, right, {to_label, from_label, apex_label});
    }
    const Floats tolerance = Simd::fill(k_on_ray) * apex.reach;
    const Mask inside_right = tolerance < apex.from_right, inside_left = tolerance < apex.to_left;
    const Ints clearances = Simd::load(apexes.clearances + i);
    const Floats left_clearance = Simd::floats_of(clearances & Simd::fill_int(k_upper_half));
    const Floats right_clearance = Simd::floats_of(clearances << 16);

    const Floats none = Simd::fill(0);
    Flank right_flank{rays.right_x, rays.right_y, rays.right_reach, none};
    Flank left_flank{rays.left_x, rays.left_y, rays.left_reach, none};
    ChildWindow left_child{}, right_child{};
    if constexpr (All) {
      const Flank flank = flank_at(apex, none);
      const Floats most = Simd::look_up_lane(scene.limits, Simd::load(w.edge + i));
      left_child = child_in_disk(left, inside_right, right_flank, flank, left_clearance, most);
      right_child = child_in_disk(right, inside_left, left_flank, flank, right_clearance, most);
    } else {
      const Flank flank = flank_at(apex, Simd::load(apexes.way + i));
      const Floats most = Simd::load(w.most + i);
      right_flank.way = Simd::load(w.right_way + i);
      left_flank.way = Simd::load(w.left_way + i);
      left_child = child_behind(left, inside_right, left_flank, right_flank, flank, left_clearance, most, scene.excess,
                                scene.per_detour);
      right_child = child_behind(right, inside_left, mirrored(right_flank), mirrored(left_flank), mirrored(flank),
                                 right_clearance, most, scene.excess, scene.per_detour);
      right_child.far = mirrored(right_child.far);
    }
    const Ints root = Simd::load(w.root + i);
    *left_count = append_children<All, false>(lefts, *left_count, corners, left_flank, left_child, left_edge, root);
    *right_count =
        append_children<All, true>(rights, *right_count, corners, right_flank, right_child, right_edge, root);
  }
}

void aim(const SightingRows& seen, const std::int32_t* chosen, int count, double* lengths, float* leaving,
         float* back) {
  for (int i = 0; i < count; i += Simd::width) {
    const Ints index = Simd::load(chosen + i);
    const Doubles x = Simd::look_up(seen.x, index), y = Simd::look_up(seen.y, index);
    Simd::store(lengths + i, Simd::sqrt(x * x + y * y));
    const Floats px = Simd::narrow(x), py = Simd::narrow(y);
    const Floats side_x = Simd::look_up(seen.back_x, index), side_y = Simd::look_up(seen.back_y, index);
    Simd::store(leaving + i, angle_of(px, py));
    Simd::store(back + i, angle_back(px, py, side_x, side_y));
  }
}

int find_target(const std::uint64_t* words, int count, std::uint64_t mask, std::uint64_t target) {
  for (int i = 0; i < count; i += Simd::width) {
    const unsigned here = Simd::matches(words + i, mask, target);
    if (here == 0) continue;
    const int first = i + __builtin_ctz(here);
    return first < count ? first : -1;
  }
  return -1;
}

}  // namespace

extern const WaveKernel SADDLEBACK_WAVE_KERNEL;
const WaveKernel SADDLEBACK_WAVE_KERNEL{Simd::name,         sight<false>,      sight<true>, split<false, false>,
                                        split<false, true>, split<true, true>, aim,         find_target};

}  // namespace saddleback
