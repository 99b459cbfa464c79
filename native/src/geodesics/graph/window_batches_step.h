#pragma once
// The step of one window, for as many at a time as `Simd` has lanes: shared by the vector kernels
// (window_waves_kernel.h) and the CUDA kernel, whose lanes are threads. The including source defines `Simd`, and
// SADDLEBACK_STEP as what its functions need to be called. Multiplications and additions are not fused and roots and
// quotients are IEEE's, so that every machine gives the same bits.
//
// Windows and their filters: [xin2009]. To keep an arc only where no way over a flank will do, and to end windows
// there: [adikusuma2020]. Their rule allows every detour the same share of the whole way, and such shares add up where
// the second leg is itself a detour. Here a way counts the graph's distance to the flank, and the rest with the whole
// tolerance on top: way + (1 + e) rest <= (1 + e) straight. By induction over lengths no distance in the graph is then
// longer than 1 + e times the geodesic, as far as windows have run; their end is a bound on one detour alone, with a
// factor found by measuring.
//
// By the same inequality, at the distances that are still ahead of it, the cone of a window is narrowed to what its
// flanks do not serve: a quarter fewer windows, among needles a third, and the same arcs but for one in two hundred. A
// flank is taken to see all of what it serves, so that this, too, is a window's end, and measured.

namespace saddleback {
namespace {

using Floats = Simd::Floats;
using Doubles = Simd::Doubles;
using Ints = Simd::Ints;
using Mask = Simd::Mask;

// The sine between two directions below which float arithmetic cannot tell a vertex from one on the ray itself.
constexpr float k_on_ray = 1e-6f;
// Squares must differ by more than rounding before a filter removes a window.
constexpr float k_shorter = (1 - 1e-6f) * (1 - 1e-6f);
// The share of the half-edge below which a window is too narrow to reach another vertex.
constexpr float k_narrow = 1e-6f;
// The bits of a record's left clearance.
constexpr std::int32_t k_upper_half = ~0xffff;

SADDLEBACK_STEP Floats square(Floats a) { return a * a; }
SADDLEBACK_STEP Floats length_squared(Floats x, Floats y) { return x * x + y * y; }
SADDLEBACK_STEP Floats cross(Floats ax, Floats ay, Floats bx, Floats by) { return ax * by - ay * bx; }

/// The two rays of a window, and how far the vertices are that they run through: its flanks.
struct Rays {
  Floats right_x, right_y, left_x, left_y;  ///< unit vectors
  Floats right_reach, left_reach;
};

/// Holds how a window sees the far corner of its face.
struct ApexView {
  Floats x, y, reach;
  Floats from_right, to_left;  ///< offsets from the rays, positive inside
  Mask in_sight;
  Mask inside;  ///< and on neither ray: a vertex on a ray is reached by the flank as well
};

SADDLEBACK_STEP ApexView view_apex(Floats x, Floats y, const Rays& rays) {
  const Floats reach = Simd::sqrt(length_squared(x, y));
  const Floats from_right = cross(rays.right_x, rays.right_y, x, y), to_left = cross(x, y, rays.left_x, rays.left_y);
  const Floats tolerance = Simd::fill(k_on_ray) * reach, border = Simd::fill(0) - tolerance;
  const Mask in_sight = (border < from_right) & (border < to_left);
  const Mask inside = (tolerance < from_right) & (tolerance < to_left);
  return {x, y, reach, from_right, to_left, in_sight, inside};
}

/// The shortest way to the apex by one of the flanks: `right_way` and `left_way` bound the graph's distances to them,
/// and `detour` is what a way may be longer by than a straight geodesic.
SADDLEBACK_STEP Floats way_by_flank(const ApexView& apex, const Rays& rays, Floats right_way, Floats left_way,
                                    Floats detour) {
  const Floats by_right = right_way + detour * Simd::sqrt(length_squared(apex.x - rays.right_reach * rays.right_x,
                                                                         apex.y - rays.right_reach * rays.right_y));
  const Floats by_left = left_way + detour * Simd::sqrt(length_squared(apex.x - rays.left_reach * rays.left_x,
                                                                       apex.y - rays.left_reach * rays.left_y));
  return Simd::min(by_right, by_left);
}

/// A vertex that a window's ray runs through.
struct Flank {
  Floats x, y;   ///< unit vector to it
  Floats reach;  ///< distance from the source
  Floats way;    ///< bound of the graph's distance
};

/// The distance from which on a flank serves all vertices whose directions are off its own by an angle at most: with r
/// its reach, w its way and k the factor that a way may be longer by, the larger root of
/// (k^2 - 1) D^2 - 2 (k w - r cos) D + w^2 - r^2 = 0, from w + |flank to vertex| = k D.
///
/// Flanks nearer than a mean edge are allowed less: they leave nearly the whole way to others, which may be detours in
/// their turn. `allowed` is what a way may be longer by, less 1.
SADDLEBACK_STEP Floats serving_distance(const Flank& flank, Floats angle, float allowed) {
  const Floats one = Simd::fill(1), half = Simd::fill(0.5f);
  const Floats excess = Simd::fill(allowed) * Simd::min(flank.reach, one);
  const Floats surplus = excess * (excess + one + one);
  const Floats b = (one + excess) * flank.way - flank.reach + half * flank.reach * square(angle);
  const Floats c = surplus * (flank.reach - flank.way) * (flank.reach + flank.way);
  return Simd::quotient(b + Simd::sqrt(Simd::max(b * b + c, Simd::fill(0))), surplus);
}

/// The radius beyond which the way by one of two flanks does for all vertices between them; q is to the left.
SADDLEBACK_STEP Floats serving_radius(const Flank& p, const Flank& q, float allowed, Floats most) {
  const Floats zero = Simd::fill(0), cosine = p.x * q.x + p.y * q.y, sine = cross(p.x, p.y, q.x, q.y);
  // An upper bound of the angle (Huygens), closer than rounding for all that are small enough to count.
  const Floats angle = (sine + sine + Simd::quotient(sine, cosine)) * Simd::fill(1.0f / 3);
  // Far away the detours are r (1 - cos): divide the angle so that they are the same.
  const Floats p_root = Simd::sqrt(p.reach), q_root = Simd::sqrt(q.reach);
  const Floats off_p = angle * Simd::quotient(q_root, p_root + q_root), off_q = angle - off_p;
  const Floats bound = Simd::max(serving_distance(p, off_p, allowed), serving_distance(q, off_q, allowed));
  return Simd::pick((zero < cosine) & (bound < most), bound, most);
}

/// Returns how far off a flank's direction it serves all vertices that are at least so far away: the tangent of an
/// angle. With r, w and k as above, w + k |flank to vertex| <= k D holds where r cos >= w / k + (r^2 - (w / k)^2) / (2
/// D), and so for tangents up to the root of twice what that leaves of 1 - cos. Nothing where w exceeds k r.
/// `per_detour` is 1 / k.
SADDLEBACK_STEP Floats serving_tangent(const Flank& flank, Floats distance, float per_detour) {
  const Floats zero = Simd::fill(0), half = Simd::fill(0.5f);
  const Floats way = Simd::fill(per_detour) * flank.way, middle = half * (flank.reach + way);
  const Floats spared = Simd::max(flank.reach - way, zero), far = Simd::max(distance, middle);
  return Simd::sqrt(Simd::quotient((spared + spared) * (far - middle), far * flank.reach));
}

/// The rays of a window turned inwards, by serving_tangent of each flank. They become a little longer than unit
/// vectors.
SADDLEBACK_STEP Rays turn_inwards(const Rays& rays, Floats right_tangent, Floats left_tangent) {
  return {rays.right_x - right_tangent * rays.right_y,
          rays.right_y + right_tangent * rays.right_x,
          rays.left_x + left_tangent * rays.left_y,
          rays.left_y - left_tangent * rays.left_x,
          rays.right_reach,
          rays.left_reach};
}

/// One side of a window's face, in the words of its left side: from the start of the half-edge, the *near* end, to the
/// apex. The right side is the left one of the mirror image, y upside down, to the bit.
struct Side {
  Mask beam;                            ///< any cone covers a part of it
  Mask cut;                             ///< the cone ends at the apex
  Floats near_x, near_y, far_x, far_y;  ///< ends of the half-edge
  Floats apex_x, apex_y;
  Floats near_ray_x, near_ray_y, far_ray_x, far_ray_y;  ///< where the cone ends
  Floats apex_off, apex_in;                             ///< offsets of the apex from the two, positive inside
};

/// Holds what the cone on a side has to tell.
struct Child {
  Mask useful;
  Floats begin, end;                    ///< of the cone, from the near end on, as parts of the side
  Floats begin_x, begin_y;              ///< where it begins
  Floats begin_squared, end_squared;    ///< distances of the cone's ends from the source
  Floats begin_ahead, end_ahead;        ///< how far the source's foot is behind them, times the side's length
  Floats foot_squared, length_squared;  ///< distance of the foot times the side's length; both squared
};

SADDLEBACK_STEP Child look_at(const Side& side) {
  const Floats zero = Simd::fill(0), one = Simd::fill(1);
  const Floats along_x = side.apex_x - side.near_x, along_y = side.apex_y - side.near_y;
  const Floats near_off = Simd::max(cross(side.near_ray_x, side.near_ray_y, side.near_x, side.near_y), zero);
  const Floats near_in = Simd::max(cross(side.far_ray_x, side.far_ray_y, side.near_x, side.near_y), zero);
  // The apex of a side that a cone covers is off the ray by more than nothing.
  const Floats begin = Simd::share(near_off, side.apex_off);
  const Floats end = Simd::pick(side.cut, one, Simd::min(Simd::quotient(near_in, near_in - side.apex_in), one));
  const Mask useful = side.beam & (Simd::fill(k_narrow) < end - begin);
  const Floats begin_x = side.near_x + begin * along_x, begin_y = side.near_y + begin * along_y;
  const Floats end_x = side.near_x + end * along_x, end_y = side.near_y + end * along_y;
  const Floats begin_ahead = begin_x * along_x + begin_y * along_y, end_ahead = end_x * along_x + end_y * along_y;
  return {useful,
          begin,
          end,
          begin_x,
          begin_y,
          length_squared(begin_x, begin_y),
          length_squared(end_x, end_y),
          begin_ahead,
          end_ahead,
          square(cross(side.near_x, side.near_y, along_x, along_y)),
          length_squared(along_x, along_y)};
}

/// Upper bounds of the distances of a face's corners, in the words of a side.
struct CornerLabels {
  Floats near, far, apex;
};
/// Tells whether a corner of the face offers every point of the cone a shorter way: three filters.
SADDLEBACK_STEP Mask is_served_by_corner(const Side& side, const Child& child, const CornerLabels& labels) {
  const Floats zero = Simd::fill(0), one = Simd::fill(1), shorter = Simd::fill(k_shorter);
  const Floats length = Simd::sqrt(child.length_squared);
  const Floats by_near = labels.near + child.end * length, by_apex = labels.apex + (one - child.begin) * length;
  const Floats left_over = Simd::sqrt(child.begin_squared * shorter) - labels.far;
  const Floats across_2 = length_squared(child.begin_x - side.far_x, child.begin_y - side.far_y);
  return (square(by_near) < child.end_squared * shorter) | (square(by_apex) < child.begin_squared * shorter) |
         ((zero < left_over) & (across_2 < square(left_over)));
}

/// Tells whether the cone may reach a vertex nearer than `most`: its nearest point on the side, an end or the source's
/// foot, is nearer by more than how far the next vertex beyond the side is at least.
SADDLEBACK_STEP Mask is_within(const Child& child, Floats most, Floats clearance) {
  const Floats zero = Simd::fill(0), most_2 = square(Simd::max(most - clearance, zero));
  return Simd::pick(zero < child.begin_ahead, child.begin_squared < most_2,
                    Simd::pick(child.end_ahead < zero, child.end_squared < most_2,
                               child.foot_squared < most_2 * child.length_squared));
}

/// Returns how far the nearest vertex is at least that the cone may reach: as far as its nearest point on the side, an
/// end or the source's foot, and from there as far as the next vertex beyond the side is at least.
SADDLEBACK_STEP Floats nearest_beyond(const Child& child, Floats clearance) {
  const Floats zero = Simd::fill(0), foot_2 = Simd::quotient(child.foot_squared, child.length_squared);
  const Floats least_2 = Simd::pick(zero < child.begin_ahead, child.begin_squared,
                                    Simd::pick(child.end_ahead < zero, child.end_squared, foot_2));
  return Simd::sqrt(least_2) + clearance;
}

/// Ends of the window's half-edge.
struct FacePlaces {
  Floats from_x, from_y, to_x, to_y;
};

/// `is_open` where there is a face behind the side.
SADDLEBACK_STEP Side left_side(const FacePlaces& face, const ApexView& apex, const Rays& rays, Mask is_open) {
  const Floats tolerance = Simd::fill(k_on_ray) * apex.reach;
  const Mask inside_right = tolerance < apex.from_right, beam = is_open & (tolerance < apex.to_left);
  return {beam,   inside_right, face.from_x, face.from_y,  face.to_x,    face.to_y,    apex.x,
          apex.y, rays.left_x,  rays.left_y, rays.right_x, rays.right_y, apex.to_left, apex.from_right};
}

/// Upside down, with right and left exchanged.
SADDLEBACK_STEP FacePlaces mirrored(const FacePlaces& face) {
  const Floats zero = Simd::fill(0);
  return {face.to_x, zero - face.to_y, face.from_x, zero - face.from_y};
}
SADDLEBACK_STEP ApexView mirrored(const ApexView& apex) {
  return {apex.x, Simd::fill(0) - apex.y, apex.reach, apex.to_left, apex.from_right, apex.in_sight, apex.inside};
}
SADDLEBACK_STEP Rays mirrored(const Rays& rays) {
  const Floats zero = Simd::fill(0);
  return {rays.left_x, zero - rays.left_y, rays.right_x, zero - rays.right_y, rays.left_reach, rays.right_reach};
}

/// The flank that the apex becomes for the children whose cone ends there.
SADDLEBACK_STEP Flank flank_at(const ApexView& apex, Floats way) {
  const Floats per_reach = Simd::quotient(Simd::fill(1), apex.reach);
  return {apex.x * per_reach, apex.y * per_reach, apex.reach, way};
}
SADDLEBACK_STEP Flank mirrored(const Flank& flank) {
  return {flank.x, Simd::fill(0) - flank.y, flank.reach, flank.way};
}

/// The window behind a side.
struct ChildWindow {
  Mask useful;
  Flank far;                       ///< the other flank is the window's near one
  Floats near_served, far_served;  ///< serving_tangent of its flanks, for all that is ahead
  Floats most;                     ///< radius beyond which it serves nothing
};

/// Returns it in the words of the left side: flanks are mirrored as the side is. `cut` where the apex divides the
/// window; `most` is the window's. `allowed` and `per_detour` as for serving_distance and serving_tangent.
SADDLEBACK_STEP ChildWindow child_behind(const Child& child, Mask cut, const Flank& near, const Flank& far,
                                         const Flank& apex, Floats clearance, Floats most, float allowed,
                                         float per_detour) {
  Floats own_most = most;
  if (Simd::any(cut & child.useful)) own_most = Simd::pick(cut, serving_radius(apex, near, allowed, most), most);
  const Flank last{Simd::pick(cut, apex.x, far.x), Simd::pick(cut, apex.y, far.y),
                   Simd::pick(cut, apex.reach, far.reach), Simd::pick(cut, apex.way, far.way)};
  const Floats distance = nearest_beyond(child, clearance);
  const Floats near_served = serving_tangent(near, distance, per_detour);
  const Floats last_served = serving_tangent(last, distance, per_detour);
  const Rays cone = turn_inwards({last.x, last.y, near.x, near.y, last.reach, near.reach}, last_served, near_served);
  const Mask is_open = Simd::fill(0) < cross(cone.right_x, cone.right_y, cone.left_x, cone.left_y);
  const Mask useful = child.useful & (distance < own_most) & is_open;
  return {useful, last, near_served, last_served, own_most};
}

/// Returns the same where all that is seen counts, nearer than `most`.
SADDLEBACK_STEP ChildWindow child_in_disk(const Child& child, Mask cut, const Flank& far, const Flank& apex,
                                          Floats clearance, Floats most) {
  const Floats zero = Simd::fill(0);
  const Flank last{Simd::pick(cut, apex.x, far.x), Simd::pick(cut, apex.y, far.y), zero, zero};
  const Mask useful = child.useful & is_within(child, most, clearance);
  return {useful, last, zero, zero, most};
}

/// Returns the angle of a vector in the upper half-plane.
SADDLEBACK_STEP Floats angle_of(Floats x, Floats y) {
  const Floats zero = Simd::fill(0), width = Simd::max(x, zero - x), height = Simd::max(y, zero);
  const Floats least = Simd::min(width, height), most = Simd::max(Simd::max(width, height), Simd::fill(1e-30f));
  const Floats t = least / most, t2 = t * t;
  // Minimax polynomial of the arc tangent on [0, 1].
  const float k_terms[] = {0.05265332f, -0.11643287f, 0.19354346f, -0.33262347f, 0.99997726f};
  Floats sum = Simd::fill(-0.01172120f);
  for (const float term : k_terms) sum = sum * t2 + Simd::fill(term);
  const Floats octant = t * sum, quadrant = Simd::pick(width < height, Simd::fill(1.57079633f) - octant, octant);
  return Simd::pick(x < zero, Simd::fill(3.14159265f) - quadrant, quadrant);
}

/// The angle at which a straight way from the origin comes into (x, y), from `side`, a vector from there to the right
/// of the way.
SADDLEBACK_STEP Floats angle_back(Floats x, Floats y, Floats side_x, Floats side_y) {
  return angle_of(Simd::fill(0) - (side_x * x + side_y * y), cross(x, y, side_x, side_y));
}

}  // namespace
}  // namespace saddleback
