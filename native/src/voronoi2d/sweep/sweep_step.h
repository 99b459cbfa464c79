#pragma once
// One sweep circle, event by event: the beach curve of ellipse arcs, touching and vanishing events [ying2014] chapter
// 3.
//
// The circle grows from a site c. At radius R the points x with |x - c| + |x - s| = R form an ellipse about each site s
// inside; the outermost parts of these ellipses are the beach curve, and what lies within it is final. A site that the
// circle touches splits the arc it is seen through: a new Delaunay edge. An arc that vanishes leaves its two
// neighbors side by side: a new Voronoi vertex, hence a Delaunay triangle.
//
// No trigonometry is needed. The circle that touches the sweep circle from within at the new site p and passes through
// s has the radius |d|^2 |p| / (2 p.d), where d = p - s and p counts from c: the arc that p hits is the one with the
// largest p.d / |d|^2. With a site at c, as where speed matters, it is at least 1, the value of c itself, while sites
// as far from c as p have 1/2: equal radii need no care. Without one, several sites may be nearest: `start` takes them
// all.
//
// What is decided in doubles here (which arc is hit, in which order arcs vanish) can only be wrong where two answers
// are nearly equally right; that a triangle turns counter-clockwise is exact. The outcome is proven afterwards.
//
// Vanishing events far from each other commute, and only where a site is touched does it matter what has vanished. So
// an arc that is overdue may wait until the circle touches near it: no queue is needed. The few triangles that come out
// otherwise than in the order of the radius are exchanged afterwards.
//
// Plain functions on flat arrays, without allocation: the same code can step a circle on a device.

#include <cstdint>
#include <limits>

#include "saddleback/types.h"

#include "predicates/plane_steps.h"
#include "support/simd/two_doubles.h"

namespace saddleback::voronoi2d {

/// A part of the beach curve: an ellipse about `site`. Arcs form a ring, counter-clockwise about the center.
struct Arc {
  double x, y;           ///< the site
  double radius;         ///< when it vanishes
  Index site;            ///< k_none for a slot out of use
  Index previous, next;  ///< `next` of an unused slot is the next unused one
  Index edge;            ///< of the breakpoint to `next`: its triangle's half-edge, or ~ the arc of its
                         ///< other end
  Index sector;          ///< where `SweepState::near` knows the arc, or k_none
};

/// A circle at work. The arrays belong to the caller: room for 2 n arcs and 2 n triangles of n sites.
struct SweepState {
  double center_x, center_y;

  Arc* arcs;
  Index arcs_used = 0, free_arc = k_none, latest = 0;

  Index* near;  ///< by direction: an arc that was seen there
  Index near_count;

  Index* triangles;  ///< 4 t + k: site at corner k of triangle t, counter-clockwise
  Index* twins;      ///< of half-edge 4 t + k, from corner k to the next; k_none while there is none; 0 for k = 3
  Index triangle_count = 0;
};

/// A site by whatever number the caller knows it.
struct SweptSite {
  double x, y;
  Index site;
};

constexpr double k_never = std::numeric_limits<double>::max(),
                 k_latest = 0.5 * k_never;  ///< events lie before `k_latest`, or never

/// Returns when an arc b vanishes between the arcs a and c before and after it, where the sign of their turn must be
/// exact: the last radius of all, or never. Between two parts of one ellipse an arc stays; three sites nearly on one
/// line meet later than anything that matters, if ever.
SADDLEBACK_HOST_DEVICE inline double radius_of_flat(const Arc& a, const Arc& b, const Arc& c) {
  if (a.site == c.site) return k_never;
#ifdef __CUDA_ARCH__
  const predicates::Sign turn = predicates::orient_2d({a.x, a.y}, {b.x, b.y}, {c.x, c.y});
#else
  const predicates::Sign turn = predicates::orient_2d_by_steps({a.x, a.y}, {b.x, b.y}, {c.x, c.y});
#endif
  return turn == predicates::Sign::negative ? k_latest : k_never;
}

/// Computes anew when two arcs vanish: at the radius |v - center| + |v - b|, v being the circumcenter, if the three
/// sites turn clockwise.
SADDLEBACK_HOST_DEVICE inline void schedule(SweepState& s, Index first, Index second) {
  Arc* const arcs = s.arcs;
  Arc &b0 = arcs[first], &b1 = arcs[second];
  const Arc &a0 = arcs[b0.previous], &c0 = arcs[b0.next], &a1 = arcs[b1.previous], &c1 = arcs[b1.next];
  using Two = TwoDoubles;
  const Two at0 = Two::at(&b0.x), at1 = Two::at(&b1.x), center = Two::of(s.center_x, s.center_y);
  const Two to_a0 = Two::at(&a0.x) - at0, to_c0 = Two::at(&c0.x) - at0, from0 = at0 - center;
  const Two to_a1 = Two::at(&a1.x) - at1, to_c1 = Two::at(&c1.x) - at1, from1 = at1 - center;
  const Two ax = Two::firsts(to_a0, to_a1), ay = Two::seconds(to_a0, to_a1);
  const Two cx = Two::firsts(to_c0, to_c1), cy = Two::seconds(to_c0, to_c1);
  const Two left = ax * cy, right = ay * cx, det = left - right;
  const Two certainty =
      Two::size(det) - Two::both(predicates::detail::k_orient_bound) * (Two::size(left) + Two::size(right));
  const Two half = Two::both(0.5) / det, a2 = ax * ax + ay * ay, c2 = cx * cx + cy * cy;
  const Two x = (cy * a2 - ay * c2) * half, y = (ax * c2 - cx * a2) * half;
  const Two from_x = x + Two::firsts(from0, from1), from_y = y + Two::seconds(from0, from1);
  const Two sum = Two::root(x * x + y * y) + Two::root(from_x * from_x + from_y * from_y);
  const Two radius = Two::if_positive(det, Two::smaller(sum, Two::both(k_latest)), Two::both(k_never));
  b0.radius = radius[0];
  b1.radius = radius[1];
  if (Two::are_positive(certainty)) return;
  if (!(certainty[0] > 0)) b0.radius = radius_of_flat(a0, b0, c0);
  if (!(certainty[1] > 0)) b1.radius = radius_of_flat(a1, b1, c1);
}

SADDLEBACK_HOST_DEVICE inline Index new_arc(SweepState& s) {
  if (s.free_arc == k_none) return s.arcs_used++;
  const Index arc = s.free_arc;
  s.free_arc = s.arcs[arc].next;
  return arc;
}

/// Begins with one closed arc about the first site.
SADDLEBACK_HOST_DEVICE inline void start(SweepState& s, const SweptSite& first) {
  s.arcs[0] = {first.x, first.y, k_never, first.site, 0, 0, k_none, k_none};
  s.arcs_used = 1;
  s.free_arc = k_none;
  s.latest = 0;
  for (Index i = 0; i < s.near_count; ++i) s.near[i] = 0;
}

/// Begins with arcs about `count` sites, three or more, which are equally far from the center and in counter-clockwise
/// order about it: the center is a Voronoi vertex, their polygon a fan of triangles.
SADDLEBACK_HOST_DEVICE inline void start_about_vertex(SweepState& s, const SweptSite* sites, Index count) {
  start(s, sites[0]);
  for (Index i = 0; i < count; ++i)
    s.arcs[i] = {sites[i].x, sites[i].y, k_never, sites[i].site, i == 0 ? count - 1 : i - 1, i + 1 == count ? 0 : i + 1,
                 k_none,     k_none};
  s.arcs_used = count;
  for (Index i = 1; i + 1 < count; ++i) {
    const Index half = 4 * s.triangle_count++;
    const Index corners[3] = {0, i, i + 1};
    for (int k = 0; k < 3; ++k) {
      s.triangles[half + k] = sites[corners[k]].site;
      s.twins[half + k] = k_none;
    }
    s.twins[half + 3] = 0;
    if (i > 1) {
      s.twins[half] = half - 2;
      s.twins[half - 2] = half;
    }
    s.arcs[i].edge = half + 1;
  }
  s.arcs[0].edge = 0;
  s.arcs[count - 1].edge = 4 * s.triangle_count - 2;
}

/// A new site as the beach curve sees it: (x, y) counts from the center.
struct Touch {
  double site_x, site_y, x, y;
};

/// Holds how far out an arc is in the direction of the new site, as a number that grows with that distance.
struct Height {
  double along, squared;  ///< p.d and |d|^2
  SADDLEBACK_HOST_DEVICE double value() const { return along / squared; }
};
SADDLEBACK_HOST_DEVICE inline Height height(const Touch& p, const Arc& arc) {
  const double x = p.site_x - arc.x, y = p.site_y - arc.y;
  return {p.x * x + p.y * y, x * x + y * y};
}

enum class Turn { here, ahead, back };

/// Returns the turn for an arc that is further out in the direction of p than both neighbors: whether p hits it, or
/// where to go on. One ellipse is outside another in one interval of directions, whose middle is m = s w' - s' w with w
/// = |p|^2 - |s|^2 = 2 p.d - |d|^2: p must come after the middle of the previous arc's and before the next one's.
SADDLEBACK_HOST_DEVICE inline Turn turn_to(const SweepState& s, const Touch& p, const Arc& arc, const Height& here,
                                           const Height& before, const Height& after) {
  const Arc &a = s.arcs[arc.previous], &c = s.arcs[arc.next];
  if (a.site == c.site) return Turn::here;
  const double w = 2 * here.along - here.squared, wa = 2 * before.along - before.squared,
               wc = 2 * after.along - after.squared;
  const double bx = arc.x - s.center_x, by = arc.y - s.center_y;
  const double ax = (a.x - s.center_x) * w - bx * wa, ay = (a.y - s.center_y) * w - by * wa;
  const double cx = (c.x - s.center_x) * w - bx * wc, cy = (c.y - s.center_y) * w - by * wc;
  const bool left_of_a = ax * p.y - ay * p.x >= 0, right_of_c = p.x * cy - p.y * cx >= 0;
  if (left_of_a && right_of_c) return Turn::here;
  if (left_of_a != right_of_c && ax * cy - ay * cx <= 0) return Turn::here;
  return right_of_c ? Turn::back : Turn::ahead;
}

/// Returns the arc that is the furthest out of all, where rounding misleads every walk.
SADDLEBACK_HOST_DEVICE inline Index highest_arc(const SweepState& s, const Touch& p, Index from) {
  Index best = from;
  for (Index arc = s.arcs[from].next; arc != from; arc = s.arcs[arc].next)
    if (height(p, s.arcs[arc]).value() > height(p, s.arcs[best]).value()) best = arc;
  return best;
}

/// A walker on the beach curve, with the heights of its arc and of the two beside it.
struct Walker {
  Index arc;
  Height here, before, after;
  double value, value_before, value_after;

  SADDLEBACK_HOST_DEVICE Walker(const SweepState& s, const Touch& p, Index start)
      : arc(start),
        here(height(p, s.arcs[start])),
        before(height(p, s.arcs[s.arcs[start].previous])),
        after(height(p, s.arcs[s.arcs[start].next])),
        value(here.value()),
        value_before(before.value()),
        value_after(after.value()) {}
  SADDLEBACK_HOST_DEVICE bool is_on_top() const { return value_before <= value && value_after <= value; }
  SADDLEBACK_HOST_DEVICE void go_ahead(const SweepState& s, const Touch& p) {
    before = here, value_before = value;
    here = after, value = value_after;
    arc = s.arcs[arc].next;
    after = height(p, s.arcs[s.arcs[arc].next]);
    value_after = after.value();
  }
  SADDLEBACK_HOST_DEVICE void go_back(const SweepState& s, const Touch& p) {
    after = here, value_after = value;
    here = before, value = value_before;
    arc = s.arcs[arc].previous;
    before = height(p, s.arcs[s.arcs[arc].previous]);
    value_before = before.value();
  }
  SADDLEBACK_HOST_DEVICE bool is_hit(const SweepState& s, const Touch& p) const {
    return is_on_top() && turn_to(s, p, s.arcs[arc], here, before, after) == Turn::here;
  }
};

/// The arc that p hits, walking along the beach from one that may be near. O(1) expected, O(arcs) at worst.
///
/// The first walk climbs to an arc that is further out than both neighbors. Several arcs may be: parts of one ellipse
/// with others between. Two more walks pass these, one each way, the likelier first.
SADDLEBACK_HOST_DEVICE inline Index hit_arc(const SweepState& s, const Touch& p, Index from) {
  Walker walker(s, p, from);
  while (!walker.is_on_top()) {
    if (walker.value_after >= walker.value_before) {
      walker.go_ahead(s, p);
    } else {
      walker.go_back(s, p);
    }
  }
  const Turn turn = turn_to(s, p, s.arcs[walker.arc], walker.here, walker.before, walker.after);
  if (turn == Turn::here) return walker.arc;
  Walker ahead = walker, back = walker;
  for (Index step = 0; step <= s.arcs_used; ++step) {
    if (turn == Turn::ahead || step > 1) ahead.go_ahead(s, p);
    if (turn == Turn::back || step > 1) back.go_back(s, p);
    if (ahead.is_hit(s, p)) return ahead.arc;
    if (back.is_hit(s, p)) return back.arc;
  }
  return highest_arc(s, p, from);
}

/// Number of the sector of a direction: an angle without trigonometry.
SADDLEBACK_HOST_DEVICE inline Index sector_of(const SweepState& s, double x, double y) {
  const double share = y / (fabs(x) + fabs(y));    // -1 to 1
  const double turn = 2 - copysign(1 - share, x);  // 1 + share to the right, 3 - share to the left
  const Index sector = static_cast<Index>(turn * (0.25 * s.near_count));
  return sector < s.near_count ? sector : s.near_count - 1;
}

/// Returns a live arc that was seen in about this direction: of those on both sides the one further out there, since
/// the way along the beach from one to the other may be long.
SADDLEBACK_HOST_DEVICE inline Index arc_near(const SweepState& s, const Touch& p, Index sector) {
  const Index mask = s.near_count - 1;
  if (s.arcs[s.near[sector]].sector == sector) {
    const Index up = s.near[(sector + 1) & mask], down = s.near[(sector - 1) & mask], here = s.near[sector];
    Index best = here;
    double best_value = height(p, s.arcs[here]).value();
    const Index others[2] = {up, down};
    for (int k = 0; k < 2; ++k) {
      const Index other = others[k];
      const double value = height(p, s.arcs[other]).value();
      if (value > best_value && s.arcs[other].site != k_none) best = other, best_value = value;
    }
    return best;
  }
  for (Index step = 1; 2 * step <= s.near_count && step < 16; ++step) {
    const Index up = (sector + step) & mask, down = (sector - step) & mask;
    const bool is_up = s.arcs[s.near[up]].sector == up, is_down = s.arcs[s.near[down]].sector == down;
    if (is_up && is_down)
      return height(p, s.arcs[s.near[up]]).value() > height(p, s.arcs[s.near[down]]).value() ? s.near[up]
                                                                                             : s.near[down];
    if (is_up || is_down) return s.near[is_up ? up : down];
  }
  return s.latest;
}

/// The triangle of half-edge `half` lies beyond a breakpoint whose inner side is `edge`.
SADDLEBACK_HOST_DEVICE inline void join(SweepState& s, Index edge, Index half) {
  // A negative one has no triangle yet on that side: it will come at the other end. Which one it is no processor
  // predicts, so both are written without a branch.
  *(edge < 0 ? &s.arcs[~edge].edge : &s.twins[edge]) = half;
  s.twins[half] = edge < 0 ? k_none : edge;
}

/// Takes an arc out of the ring and adds its triangle. The events of the two beside it are then to be computed anew.
SADDLEBACK_HOST_DEVICE inline void remove(SweepState& s, Index arc) {
  Arc& b = s.arcs[arc];
  const Index before = b.previous, after = b.next;
  Arc &a = s.arcs[before], &c = s.arcs[after];
  const Index half = 4 * s.triangle_count++;
  s.triangles[half] = a.site;
  s.triangles[half + 1] = c.site;
  s.triangles[half + 2] = b.site;
  s.twins[half] = s.twins[half + 1] = s.twins[half + 2] = k_none;
  s.twins[half + 3] = 0;
  join(s, a.edge, half + 2);
  join(s, b.edge, half + 1);
  a.edge = half;
  a.next = after;
  c.previous = before;
  b.site = b.sector = k_none;
  b.radius = k_never;
  b.next = s.free_arc;
  s.free_arc = arc;
  if (s.latest == arc) s.latest = after;
}

/// Vanishing event: the neighbors meet at a Voronoi vertex. Returns the one before.
SADDLEBACK_HOST_DEVICE inline Index vanish(SweepState& s, Index arc) {
  const Index before = s.arcs[arc].previous, after = s.arcs[arc].next;
  remove(s, arc);
  schedule(s, before, after);
  return before;
}

/// Lets arcs vanish about one that is overdue, the soonest first. Returns one that is left there.
SADDLEBACK_HOST_DEVICE inline Index settle(SweepState& s, Index arc, double radius) {
  while (s.arcs[arc].radius <= radius) {
    const Arc& b = s.arcs[arc];
    const double before = s.arcs[b.previous].radius, after = s.arcs[b.next].radius;
    const Index sooner = before < after ? b.previous : b.next;
    if ((before < after ? before : after) < b.radius) {
      arc = sooner;
      continue;
    }
    const Index left = vanish(s, arc), right = s.arcs[left].next;
    arc = s.arcs[left].radius < s.arcs[right].radius ? left : right;
  }
  return arc;
}

/// Returns an arc that should have vanished up to a radius: this one, one beside it, or k_none.
SADDLEBACK_HOST_DEVICE inline Index overdue_at(const SweepState& s, Index arc, double radius) {
  const Arc& b = s.arcs[arc];
  if (b.radius <= radius) return arc;
  if (s.arcs[b.previous].radius <= radius) return b.previous;
  if (s.arcs[b.next].radius <= radius) return b.next;
  return k_none;
}

/// Touching event: the site splits the arc it is seen through. Up to `radius` arcs near it vanish before. Returns its
/// arc.
SADDLEBACK_HOST_DEVICE inline Index touch(SweepState& s, const SweptSite& site, double radius) {
  const Touch p{site.x, site.y, site.x - s.center_x, site.y - s.center_y};
  const Index sector = sector_of(s, p.x, p.y);
  Index left = hit_arc(s, p, arc_near(s, p, sector));
  for (Index overdue = overdue_at(s, left, radius); overdue != k_none; overdue = overdue_at(s, left, radius))
    left = hit_arc(s, p, settle(s, overdue, radius));
  const Index middle = new_arc(s);
  Arc& l = s.arcs[left];
  Arc& m = s.arcs[middle];
  m = {site.x, site.y, k_never, site.site, left, left, ~left, sector};
  s.near[sector] = middle;
  s.latest = middle;
  if (l.next == left) {  // the first arc is closed: opened, not split
    l.next = l.previous = middle;
    l.edge = ~middle;
    return middle;
  }
  const Index right = new_arc(s);
  Arc& r = s.arcs[right];
  r = {l.x, l.y, k_never, l.site, middle, l.next, l.edge, k_none};
  if (r.edge < 0) s.arcs[~r.edge].edge = ~right;
  s.arcs[l.next].previous = right;
  l.next = middle;
  m.next = right;
  l.edge = ~middle;
  schedule(s, left, right);
  return middle;
}

}  // namespace saddleback::voronoi2d
