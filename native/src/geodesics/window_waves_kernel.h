// The kernel of window_waves.h, included by one source an instruction set, which defines `Simd` (see support/simd_*.h)
// and SADDLEBACK_WAVE_KERNEL.

#include "geodesics/window_waves.h"

#define SADDLEBACK_STEP inline
#include "geodesics/window_waves_step.h"

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

template <bool All>
void split(const WaveScene& scene, const WindowRows& w, int count, const ApexRows& apexes, const WindowRows& lefts,
           int* left_count, const WindowRows& rights, int* right_count) {
  int l = *left_count, r = *right_count;
  for (int i = 0; i < count; i += Simd::width) {
    const Ints left_edge = Simd::load(apexes.left + i), right_edge = Simd::load(apexes.right + i);
    const Mask active = Simd::first(count - i);
    const Doubles from_dx = Simd::load(w.from_x + i), from_dy = Simd::load(w.from_y + i);
    const Doubles to_dx = Simd::load(w.to_x + i), to_dy = Simd::load(w.to_y + i);
    const Doubles apex_dx = Simd::load(apexes.x + i), apex_dy = Simd::load(apexes.y + i);
    const Rays rays = load_rays(w, i);
    const FacePlaces face{Simd::narrow(from_dx),
                          Simd::narrow(from_dy),
                          Simd::narrow(to_dx),
                          Simd::narrow(to_dy),
                          Simd::look_up(scene.labels, w.from + i),
                          Simd::look_up(scene.labels, w.to + i),
                          Simd::look_up(scene.labels, apexes.slot + i)};
    const ApexView apex{Simd::narrow(apex_dx),
                        Simd::narrow(apex_dy),
                        Simd::load(apexes.reach + i),
                        Simd::load(apexes.from_right + i),
                        Simd::load(apexes.to_left + i),
                        {},
                        {}};
    const Side to_left = left_side(face, apex, rays, active & (!Simd::negative(left_edge)));
    const Side to_right =
        left_side(mirrored(face), mirrored(apex), mirrored(rays), active & (!Simd::negative(right_edge)));
    const Child left = look_at(to_left), right = look_at(to_right);
    const Mask inside_right = to_left.cut, inside_left = to_right.cut;
    const Floats reach = apex.reach;
    const ApexRay ray = ray_to(apex);
    Floats most = Simd::load(w.most + i), left_most = most, right_most = most;
    if constexpr (All) {
      left_most = right_most = Simd::look_up_lane(scene.limits, Simd::load(w.edge + i));
    } else if (const Mask covered = inside_right & inside_left & (left.useful | right.useful); Simd::any(covered)) {
      const Flank flank{reach, Simd::load(apexes.way + i)};
      const Floats left_bound =
          bound_child(to_left, ray, flank, {rays.left_reach, Simd::load(w.left_way + i)}, scene.excess, most);
      const Floats right_bound = bound_child(to_right, {ray.x, Simd::fill(0) - ray.y}, flank,
                                             {rays.right_reach, Simd::load(w.right_way + i)}, scene.excess, most);
      left_most = Simd::pick(covered, left_bound, most);
      right_most = Simd::pick(covered, right_bound, most);
    }

    const Ints root = Simd::load(w.root + i), clearances = Simd::load(apexes.clearances + i);
    const Floats left_clearance = Simd::floats_of(clearances & Simd::fill_int(k_upper_half));
    const Floats right_clearance = Simd::floats_of(clearances << 16);
    if (const Mask keep = left.useful & is_within(left, left_most, left_clearance); Simd::any(keep)) {
      const auto packing = Simd::packing(keep);
      packing.store(lefts.from_x + l, from_dx);
      packing.store(lefts.from_y + l, from_dy);
      packing.store(lefts.to_x + l, apex_dx);
      packing.store(lefts.to_y + l, apex_dy);
      packing.store(lefts.right_x + l, Simd::pick(inside_right, ray.x, rays.right_x));
      packing.store(lefts.right_y + l, Simd::pick(inside_right, ray.y, rays.right_y));
      packing.store(lefts.right_reach + l, Simd::pick(inside_right, reach, rays.right_reach));
      if constexpr (!All) {
        packing.store(lefts.right_way + l,
                      Simd::pick(inside_right, Simd::load(apexes.way + i), Simd::load(w.right_way + i)));
        packing.store(lefts.left_way + l, Simd::load(w.left_way + i));
      }
      packing.store(lefts.left_x + l, rays.left_x);
      packing.store(lefts.left_y + l, rays.left_y);
      packing.store(lefts.left_reach + l, rays.left_reach);
      packing.store(lefts.most + l, left_most);
      packing.store(lefts.edge + l, left_edge);
      packing.store(lefts.from + l, Simd::load(w.from + i));
      packing.store(lefts.to + l, Simd::load(apexes.slot + i));
      packing.store(lefts.root + l, root);
      l += packing.count();
    }
    if (const Mask keep = right.useful & is_within(right, right_most, right_clearance); Simd::any(keep)) {
      const auto packing = Simd::packing(keep);
      packing.store(rights.from_x + r, apex_dx);
      packing.store(rights.from_y + r, apex_dy);
      packing.store(rights.to_x + r, to_dx);
      packing.store(rights.to_y + r, to_dy);
      packing.store(rights.right_x + r, rays.right_x);
      packing.store(rights.right_y + r, rays.right_y);
      packing.store(rights.right_reach + r, rays.right_reach);
      packing.store(rights.left_x + r, Simd::pick(inside_left, ray.x, rays.left_x));
      packing.store(rights.left_y + r, Simd::pick(inside_left, ray.y, rays.left_y));
      packing.store(rights.left_reach + r, Simd::pick(inside_left, reach, rays.left_reach));
      if constexpr (!All) {
        packing.store(rights.left_way + r,
                      Simd::pick(inside_left, Simd::load(apexes.way + i), Simd::load(w.left_way + i)));
        packing.store(rights.right_way + r, Simd::load(w.right_way + i));
      }
      packing.store(rights.most + r, right_most);
      packing.store(rights.edge + r, right_edge);
      packing.store(rights.from + r, Simd::load(apexes.slot + i));
      packing.store(rights.to + r, Simd::load(w.to + i));
      packing.store(rights.root + r, root);
      r += packing.count();
    }
  }
  *left_count = l;
  *right_count = r;
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
const WaveKernel SADDLEBACK_WAVE_KERNEL{Simd::name,  sight<false>, sight<true>, split<false>,
                                        split<true>, aim,          find_target};

}  // namespace saddleback
