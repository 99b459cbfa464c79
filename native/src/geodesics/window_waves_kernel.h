// The kernel of window_waves.h, included by one source a instruction set, which defines `Simd` (see support/simd_*.h)
// and SADDLEBACK_WAVE_KERNEL. Multiplications and additions are not fused and roots and quotients are IEEE's, so that
// every instruction set gives the same bits.
//
// Windows and their filters: Xin and Wang 2009. To keep an arc only where no way over a flank will do, and to end
// windows there: Adikusuma, Fang and He 2020 ("Fast construction of discrete geodesic graphs"). Their rule allows every
// detour the same share of the whole way, and such shares add up where the second leg is itself a detour. Here a way
// counts the graph's distance to the flank, and the rest with the whole tolerance on top: way + (1 + e) rest <= (1 + e)
// straight. By induction over lengths no distance in the graph is then longer than 1 + e times the geodesic, as far as
// windows have run; their end is a bound on one detour alone, with a factor found by measuring.

#include "geodesics/window_waves.h"

namespace saddleback {
namespace {

using Floats = Simd::Floats;
using Doubles = Simd::Doubles;
using Ints = Simd::Ints;
using Mask = Simd::Mask;

// Of the sine between two directions: what float arithmetic cannot tell from a vertex on the ray itself.
constexpr float k_on_ray = 1e-6f;
// Squares must differ by more than rounding before a filter removes a window.
constexpr float k_shorter = (1 - 1e-6f) * (1 - 1e-6f);
// Of the half-edge: narrower windows serve no further vertex.
constexpr float k_narrow = 1e-6f;

Floats square(Floats a) { return a * a; }
Floats length_squared(Floats x, Floats y) { return x * x + y * y; }
Floats cross(Floats ax, Floats ay, Floats bx, Floats by) { return ax * by - ay * bx; }

template <bool All>
int sight(const WaveScene& scene, const WindowRows& w, int count, const ApexRows& apexes, const SightingRows& seen,
          int sightings) {
  const Ints lane_mask = Simd::fill_int(k_batch - 1);
  for (int i = 0; i < count; i += Simd::width) {
    Doubles a{}, b{};
    Ints left{}, right{}, apex{};
    Simd::load_records(scene.edges, w.edge + i, a, b, left, right, apex);
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

    const Floats px = Simd::narrow(x), py = Simd::narrow(y), reach = Simd::sqrt(length_squared(px, py));
    const Floats right_x = Simd::load(w.right_x + i), right_y = Simd::load(w.right_y + i);
    const Floats left_x = Simd::load(w.left_x + i), left_y = Simd::load(w.left_y + i);
    const Floats from_right = cross(right_x, right_y, px, py), to_left = cross(px, py, left_x, left_y);
    Simd::store(apexes.reach + i, reach);
    Simd::store(apexes.from_right + i, from_right);
    Simd::store(apexes.to_left + i, to_left);

    const Floats tolerance = Simd::fill(k_on_ray) * reach, border = Simd::fill(0) - tolerance;
    const Mask in_sight = Simd::first(count - i) & (border < from_right) & (border < to_left);
    // A vertex on a ray is reached by the flank as well.
    Mask direct = (tolerance < from_right) & (tolerance < to_left);
    if constexpr (!All) {
      const Floats right_reach = Simd::load(w.right_reach + i), left_reach = Simd::load(w.left_reach + i);
      const Floats detour = Simd::fill(scene.detour);
      const Floats by_right =
          Simd::load(w.right_way + i) +
          detour * Simd::sqrt(length_squared(px - right_reach * right_x, py - right_reach * right_y));
      const Floats by_left = Simd::load(w.left_way + i) +
                             detour * Simd::sqrt(length_squared(px - left_reach * left_x, py - left_reach * left_y));
      const Floats way = Simd::min(by_right, by_left);
      direct = direct & (detour * reach < way);
      Simd::store(apexes.way + i, Simd::pick(direct, reach, way));
    }
    const Ints bits = Simd::bits_of(reach) & Simd::fill_int(~1);
    const auto packing = Simd::packing(in_sight);
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

/// A vertex that a window's ray runs through.
struct Flank {
  Floats reach;  ///< distance from the source
  Floats way;    ///< bound of the graph's distance
};

/// The distance from which on a flank serves all vertices whose directions are off its own by an angle at most: with r
/// its reach, w its way and k the factor that a way may be longer by, the larger root of
/// (k^2 - 1) D^2 - 2 (k w - r cos) D + w^2 - r^2 = 0, from w + |flank to vertex| = k D.
///
/// Flanks nearer than a mean edge are allowed less: they leave nearly the whole way to others, which may be detours in
/// their turn.
Floats serving_distance(const Flank& flank, Floats angle, const WaveScene& scene) {
  const Floats one = Simd::fill(1), half = Simd::fill(0.5f);
  const Floats excess = Simd::fill(scene.excess) * Simd::min(flank.reach, one);
  const Floats surplus = excess * (excess + one + one);
  const Floats b = (one + excess) * flank.way - flank.reach + half * flank.reach * square(angle);
  const Floats c = surplus * (flank.reach - flank.way) * (flank.reach + flank.way);
  return (b + Simd::sqrt(Simd::max(b * b + c, Simd::fill(0)))) / surplus;
}

/// The radius beyond which the way by one of two flanks does for all vertices between them. `cosine` and `sine` are of
/// the angle between the flanks.
Floats serving_radius(Floats cosine, Floats sine, const Flank& p, const Flank& q, const WaveScene& scene, Floats most) {
  const Floats zero = Simd::fill(0);
  // An upper bound of the angle (Huygens), closer than rounding for all that are small enough to count.
  const Floats angle = (sine + sine + sine / cosine) * Simd::fill(1.0f / 3);
  // Far away the detours are r (1 - cos): divide the angle so that they are the same.
  const Floats p_root = Simd::sqrt(p.reach), q_root = Simd::sqrt(q.reach);
  const Floats off_p = angle * (q_root / (p_root + q_root)), off_q = angle - off_p;
  const Floats bound = Simd::max(serving_distance(p, off_p, scene), serving_distance(q, off_q, scene));
  return Simd::pick((zero < cosine) & (bound < most), bound, most);
}

/// One side of a window's face, in the words of its left side: from the near end of the half-edge to the apex.
struct Side {
  Mask lit;               ///< any light falls on it
  Mask cut;               ///< the light ends at the apex
  Floats near_x, near_y;  ///< end of the half-edge that the side shares
  Floats far_x, far_y;    ///< the other end
  Floats apex_x, apex_y;
  Floats near_off, apex_off;  ///< offsets of the side's ends from the ray on the near side: outside and inside
  Floats near_in, apex_out;   ///< from the other ray; used where the light does not end at the apex
  Floats near_label, far_label, apex_label;
};

/// What the light on a side has to tell.
struct Child {
  Mask useful;                          ///< no filter removes it
  Floats begin_squared, end_squared;    ///< distances of the light's ends from the source
  Floats begin_ahead, end_ahead;        ///< how far the source's foot is behind them, times the side's length
  Floats foot_squared, length_squared;  ///< distance of the foot times the side's length; both squared
};

Child look_at(const Side& side) {
  const Floats zero = Simd::fill(0), one = Simd::fill(1), shorter = Simd::fill(k_shorter);
  const Floats along_x = side.apex_x - side.near_x, along_y = side.apex_y - side.near_y;
  const Floats length_2 = length_squared(along_x, along_y), length = Simd::sqrt(length_2);
  const Floats near_off = Simd::max(side.near_off, zero), near_in = Simd::max(side.near_in, zero);
  const Floats begin = near_off / (near_off + side.apex_off);
  const Floats end = Simd::pick(side.cut, one, Simd::min(near_in / (near_in + side.apex_out), one));
  Mask useful = side.lit & (Simd::fill(k_narrow) < end - begin);
  const Floats begin_x = side.near_x + begin * along_x, begin_y = side.near_y + begin * along_y;
  const Floats end_x = side.near_x + end * along_x, end_y = side.near_y + end * along_y;
  const Floats begin_2 = length_squared(begin_x, begin_y), end_2 = length_squared(end_x, end_y);
  // A corner of the face offers every point of the light a shorter way: three filters.
  const Floats by_near = side.near_label + end * length, by_apex = side.apex_label + (one - begin) * length;
  useful = useful & (!(square(by_near) < end_2 * shorter)) & (!(square(by_apex) < begin_2 * shorter));
  const Floats left_over = Simd::sqrt(begin_2 * shorter) - side.far_label;
  const Floats across_2 = length_squared(begin_x - side.far_x, begin_y - side.far_y);
  useful = useful & (!((zero < left_over) & (across_2 < square(left_over))));
  const Floats begin_ahead = begin_x * along_x + begin_y * along_y, end_ahead = end_x * along_x + end_y * along_y;
  const Floats foot_2 = square(cross(side.near_x, side.near_y, along_x, along_y));
  return {useful, begin_2, end_2, begin_ahead, end_ahead, foot_2, length_2};
}

/// Whether the light's nearest point, an end or the source's foot on the side, is nearer than `most`.
Mask is_within(const Child& child, Floats most) {
  const Floats zero = Simd::fill(0), most_2 = square(most);
  return Simd::pick(zero < child.begin_ahead, child.begin_squared < most_2,
                    Simd::pick(child.end_ahead < zero, child.end_squared < most_2,
                               child.foot_squared < most_2 * child.length_squared));
}

template <bool All>
void split(const WaveScene& scene, const WindowRows& w, int count, const ApexRows& apexes, const WindowRows& lefts,
           int* left_count, const WindowRows& rights, int* right_count) {
  int l = *left_count, r = *right_count;
  const Floats zero = Simd::fill(0);
  for (int i = 0; i < count; i += Simd::width) {
    const Floats reach = Simd::load(apexes.reach + i), tolerance = Simd::fill(k_on_ray) * reach;
    const Floats from_right = Simd::load(apexes.from_right + i), to_left = Simd::load(apexes.to_left + i);
    const Mask active = Simd::first(count - i), inside_right = tolerance < from_right,
               inside_left = tolerance < to_left;
    const Ints left_edge = Simd::load(apexes.left + i), right_edge = Simd::load(apexes.right + i);
    const Mask go_left = active & inside_left & (!Simd::negative(left_edge));
    const Mask go_right = active & inside_right & (!Simd::negative(right_edge));

    const Doubles from_dx = Simd::load(w.from_x + i), from_dy = Simd::load(w.from_y + i);
    const Doubles to_dx = Simd::load(w.to_x + i), to_dy = Simd::load(w.to_y + i);
    const Doubles apex_dx = Simd::load(apexes.x + i), apex_dy = Simd::load(apexes.y + i);
    const Floats from_x = Simd::narrow(from_dx), from_y = Simd::narrow(from_dy);
    const Floats to_x = Simd::narrow(to_dx), to_y = Simd::narrow(to_dy);
    const Floats apex_x = Simd::narrow(apex_dx), apex_y = Simd::narrow(apex_dy);
    const Floats right_x = Simd::load(w.right_x + i), right_y = Simd::load(w.right_y + i);
    const Floats left_x = Simd::load(w.left_x + i), left_y = Simd::load(w.left_y + i);
    const Floats right_reach = Simd::load(w.right_reach + i), left_reach = Simd::load(w.left_reach + i);
    const Ints from = Simd::load(w.from + i), to = Simd::load(w.to + i), apex_slot = Simd::load(apexes.slot + i);
    const Floats from_label = Simd::look_up(scene.labels, from), to_label = Simd::look_up(scene.labels, to);
    const Floats apex_label = Simd::look_up(scene.labels, apex_slot);

    const Side left_side{go_left,
                         inside_right,
                         from_x,
                         from_y,
                         to_x,
                         to_y,
                         apex_x,
                         apex_y,
                         cross(left_x, left_y, from_x, from_y),
                         to_left,
                         cross(right_x, right_y, from_x, from_y),
                         zero - from_right,
                         from_label,
                         to_label,
                         apex_label};
    const Side right_side{go_right,
                          inside_left,
                          to_x,
                          to_y,
                          from_x,
                          from_y,
                          apex_x,
                          apex_y,
                          cross(to_x, to_y, right_x, right_y),
                          from_right,
                          cross(to_x, to_y, left_x, left_y),
                          zero - to_left,
                          to_label,
                          from_label,
                          apex_label};
    const Child left = look_at(left_side), right = look_at(right_side);

    // The ray to the apex, for children whose light ends there.
    const Floats per_reach = Simd::fill(1) / reach, ray_x = apex_x * per_reach, ray_y = apex_y * per_reach;
    Floats most = Simd::load(w.most + i), left_most = most, right_most = most;
    if constexpr (All) {
      left_most = right_most = Simd::look_up_lane(scene.limits, Simd::load(w.edge + i));
    } else if (const Mask covered = inside_right & inside_left & (left.useful | right.useful); Simd::any(covered)) {
      const Flank apex{reach, Simd::load(apexes.way + i)};
      const Flank left_flank{left_reach, Simd::load(w.left_way + i)},
          right_flank{right_reach, Simd::load(w.right_way + i)};
      const Floats left_bound = serving_radius(ray_x * left_x + ray_y * left_y, cross(ray_x, ray_y, left_x, left_y),
                                               apex, left_flank, scene, most);
      const Floats right_bound = serving_radius(right_x * ray_x + right_y * ray_y,
                                                cross(right_x, right_y, ray_x, ray_y), apex, right_flank, scene, most);
      left_most = Simd::pick(covered, left_bound, most);
      right_most = Simd::pick(covered, right_bound, most);
    }

    const Ints root = Simd::load(w.root + i);
    if (const Mask keep = left.useful & is_within(left, left_most); Simd::any(keep)) {
      const auto packing = Simd::packing(keep);
      packing.store(lefts.from_x + l, from_dx);
      packing.store(lefts.from_y + l, from_dy);
      packing.store(lefts.to_x + l, apex_dx);
      packing.store(lefts.to_y + l, apex_dy);
      packing.store(lefts.right_x + l, Simd::pick(inside_right, ray_x, right_x));
      packing.store(lefts.right_y + l, Simd::pick(inside_right, ray_y, right_y));
      packing.store(lefts.right_reach + l, Simd::pick(inside_right, reach, right_reach));
      if constexpr (!All) {
        packing.store(lefts.right_way + l,
                      Simd::pick(inside_right, Simd::load(apexes.way + i), Simd::load(w.right_way + i)));
        packing.store(lefts.left_way + l, Simd::load(w.left_way + i));
      }
      packing.store(lefts.left_x + l, left_x);
      packing.store(lefts.left_y + l, left_y);
      packing.store(lefts.left_reach + l, left_reach);
      packing.store(lefts.most + l, left_most);
      packing.store(lefts.edge + l, left_edge);
      packing.store(lefts.from + l, from);
      packing.store(lefts.to + l, apex_slot);
      packing.store(lefts.root + l, root);
      l += packing.count();
    }
    if (const Mask keep = right.useful & is_within(right, right_most); Simd::any(keep)) {
      const auto packing = Simd::packing(keep);
      packing.store(rights.from_x + r, apex_dx);
      packing.store(rights.from_y + r, apex_dy);
      packing.store(rights.to_x + r, to_dx);
      packing.store(rights.to_y + r, to_dy);
      packing.store(rights.right_x + r, right_x);
      packing.store(rights.right_y + r, right_y);
      packing.store(rights.right_reach + r, right_reach);
      packing.store(rights.left_x + r, Simd::pick(inside_left, ray_x, left_x));
      packing.store(rights.left_y + r, Simd::pick(inside_left, ray_y, left_y));
      packing.store(rights.left_reach + r, Simd::pick(inside_left, reach, left_reach));
      if constexpr (!All) {
        packing.store(rights.left_way + r,
                      Simd::pick(inside_left, Simd::load(apexes.way + i), Simd::load(w.left_way + i)));
        packing.store(rights.right_way + r, Simd::load(w.right_way + i));
      }
      packing.store(rights.most + r, right_most);
      packing.store(rights.edge + r, right_edge);
      packing.store(rights.from + r, apex_slot);
      packing.store(rights.to + r, to);
      packing.store(rights.root + r, root);
      r += packing.count();
    }
  }
  *left_count = l;
  *right_count = r;
}

/// Of a vector in the upper half-plane.
Floats angle_of(Floats x, Floats y) {
  const Floats zero = Simd::fill(0), width = Simd::max(x, zero - x), height = Simd::max(y, zero);
  const Floats least = Simd::min(width, height), most = Simd::max(Simd::max(width, height), Simd::fill(1e-30f));
  const Floats t = least / most, t2 = t * t;
  // Minimax polynomial of the arc tangent on [0, 1].
  constexpr float k_terms[] = {0.05265332f, -0.11643287f, 0.19354346f, -0.33262347f, 0.99997726f};
  Floats sum = Simd::fill(-0.01172120f);
  for (const float term : k_terms) sum = sum * t2 + Simd::fill(term);
  const Floats octant = t * sum, quadrant = Simd::pick(width < height, Simd::fill(1.57079633f) - octant, octant);
  return Simd::pick(x < zero, Simd::fill(3.14159265f) - quadrant, quadrant);
}

void aim(const SightingRows& seen, const std::int32_t* chosen, int count, double* lengths, float* leaving,
         float* back) {
  const Floats zero = Simd::fill(0);
  for (int i = 0; i < count; i += Simd::width) {
    const Ints index = Simd::load(chosen + i);
    const Doubles x = Simd::look_up(seen.x, index), y = Simd::look_up(seen.y, index);
    Simd::store(lengths + i, Simd::sqrt(x * x + y * y));
    const Floats px = Simd::narrow(x), py = Simd::narrow(y);
    const Floats side_x = Simd::look_up(seen.back_x, index), side_y = Simd::look_up(seen.back_y, index);
    Simd::store(leaving + i, angle_of(px, py));
    Simd::store(back + i, angle_of(zero - (side_x * px + side_y * py), cross(px, py, side_x, side_y)));
  }
}

int find_target(const std::uint64_t* words, int count, std::uint32_t mask, std::uint32_t target) {
  const Ints low_bits = Simd::fill_int(static_cast<std::int32_t>(mask));
  const Ints wanted = Simd::fill_int(static_cast<std::int32_t>(target));
  for (int i = 0; i < count; i += Simd::width) {
    const Mask here = ((Simd::low_words(words + i) & low_bits) == wanted) & Simd::first(count - i);
    if (Simd::any(here)) return i + Simd::first_of(here);
  }
  return -1;
}

}  // namespace

extern const WaveKernel SADDLEBACK_WAVE_KERNEL;
const WaveKernel SADDLEBACK_WAVE_KERNEL{Simd::name,  sight<false>, sight<true>, split<false>,
                                        split<true>, aim,          find_target};

}  // namespace saddleback
