// The gap between two convex hulls is closed with triangles from one common tangent to the other; then triangles are
// exchanged, from these on, until all edges pass the circle test. All decisions are exact.

#include "voronoi2d/join_meshes.h"

#include <algorithm>
#include <numeric>

namespace saddleback::voronoi2d {

using predicates::Sign;

namespace {

template <class Less>
Index better(Index a, Index b, Less&& less) {
  return less(b, a) ? b : a;
}

}  // namespace

bool MeshJoiner::find_sides(MeshPart& first, MeshPart& second, Sides& sides) const {
  const double *const x = mesh_.x, *const y = mesh_.y;
  if (x[first.rightmost] < x[second.leftmost])
    sides = {&first, &second, first.rightmost, second.leftmost, true};
  else if (x[second.rightmost] < x[first.leftmost])
    sides = {&second, &first, second.rightmost, first.leftmost, true};
  else if (y[first.highest] < y[second.lowest])
    sides = {&first, &second, first.highest, second.lowest, false};
  else if (y[second.highest] < y[first.lowest])
    sides = {&second, &first, second.highest, first.lowest, false};
  else
    return false;
  return true;
}

bool MeshJoiner::join(MeshPart& first, MeshPart& second, MeshPart& result) {
  Sides sides;
  if ((!first.has_triangles && !second.has_triangles) || !find_sides(first, second, sides)) return false;
  const auto is_left = [&](Index a, Index b) { return mesh_.x[a] < mesh_.x[b]; };
  const auto is_lower = [&](Index a, Index b) { return mesh_.y[a] < mesh_.y[b]; };
  result.leftmost = better(first.leftmost, second.leftmost, is_left);
  result.rightmost = better(second.rightmost, first.rightmost, [&](Index a, Index b) { return is_left(b, a); });
  result.lowest = better(first.lowest, second.lowest, is_lower);
  result.highest = better(second.highest, first.highest, [&](Index a, Index b) { return is_lower(b, a); });
  result.has_triangles = true;
  result.free = std::move(first.free);
  result.free.insert(result.free.end(), second.free.begin(), second.free.end());
  if (!sides.left->has_triangles) {
    join_sites(result, *sides.left, sides.right_end, sides.is_upright, false);
  } else if (!sides.right->has_triangles) {
    join_sites(result, *sides.right, sides.left_end, sides.is_upright, true);
  } else {
    close_gap(result, sides.left_end, sides.right_end);
  }
  restore(doubtful_);
  return true;
}

/// The half-edge along the border that ends where this one, along the border, begins.
Index MeshJoiner::before_on_border(Index half) const {
  Index last = previous_half(half);
  while (mesh_.twins[last] >= 0) last = previous_half(mesh_.twins[last]);
  return last;
}

Index MeshJoiner::add_triangle(MeshPart& part, Index a, Index b, Index c) {
  const Index half = part.take_triangle();
  const Index corners[3] = {a, b, c};
  for (Index k = 0; k < 3; ++k) {
    mesh_.triangles[half + k] = corners[k];
    mesh_.twins[half + k] = k_none;
    doubtful_.push_back(half + k);
  }
  mesh_.twins[half + 3] = 0;
  return half;
}

void MeshJoiner::set_twins(Index a, Index b) {
  mesh_.twins[a] = b;
  mesh_.twins[b] = a;
}

// With the one hull left, the other right: from the tangent below both upwards. Each triangle has its base on the one
// before and its tip at the next site of either hull, at that whose circle leaves the other outside.
void MeshJoiner::close_gap(MeshPart& result, Index left, Index right) {
  while (true) {
    const Index right_next = target(leaving_[right]);
    if (turn(left, right, right_next) == Sign::negative) {
      right = right_next;
      continue;
    }
    const Index left_before = mesh_.triangles[before_on_border(leaving_[left])];
    if (turn(left, right, left_before) != Sign::negative) break;
    left = left_before;
  }
  const Index lowest_left = left;
  Index first = k_none, base = k_none;
  while (true) {
    const Index left_side = leaving_[left], right_side = before_on_border(leaving_[right]);
    const Index left_tip = target(left_side), right_tip = mesh_.triangles[right_side];
    const bool sees_left = turn(left, right, left_tip) == Sign::positive,
               sees_right = turn(left, right, right_tip) == Sign::positive;
    if (!sees_left && !sees_right) break;
    const bool is_left = sees_left && (!sees_right || predicates::in_circle_by_steps(
                                                          mesh_.point(left), mesh_.point(right), mesh_.point(left_tip),
                                                          mesh_.point(right_tip)) != Sign::positive);
    const Index half = add_triangle(result, left, right, is_left ? left_tip : right_tip);
    if (base == k_none)
      first = half;
    else
      set_twins(half, base);
    if (is_left) {
      set_twins(half + 2, left_side);
      base = half + 1;
      left = left_tip;
    } else {
      set_twins(half + 1, right_side);
      base = half + 2;
      right = right_tip;
    }
  }
  leaving_[lowest_left] = first;
  leaving_[right] = base;
}

// Away from the line that parts them, each site is outside of the hull so far.
void MeshJoiner::join_sites(MeshPart& result, const MeshPart& sites, Index nearest, bool is_upright,
                            bool is_ascending) {
  order_.resize(sites.end - sites.begin);
  std::iota(order_.begin(), order_.end(), sites.begin);
  std::sort(order_.begin(), order_.end(), [&](Index a, Index b) {
    if (!is_ascending) std::swap(a, b);
    const std::pair<double, double> at_a(mesh_.x[a], mesh_.y[a]), at_b(mesh_.x[b], mesh_.y[b]);
    if (is_upright) return at_a < at_b;
    return std::pair(at_a.second, at_a.first) < std::pair(at_b.second, at_b.first);
  });
  for (const Index site : order_) nearest = join_site(result, site, nearest);
}

/// Joins a site to all edges of the hull that it sees; one of these is at the site `nearest`. Returns the site.
Index MeshJoiner::join_site(MeshPart& result, Index site, Index nearest) {
  const auto sees = [&](Index half) { return turn(mesh_.triangles[half], target(half), site) == Sign::negative; };
  Index half = leaving_[nearest], before = before_on_border(half);
  if (!sees(half)) half = before, before = before_on_border(half);
  while (sees(before)) half = before, before = before_on_border(half);
  const Index first = mesh_.triangles[half];
  Index latest = k_none, first_new = k_none;
  while (sees(half)) {
    const Index from = mesh_.triangles[half], to = target(half), beyond = leaving_[to];
    const Index added = add_triangle(result, to, from, site);
    set_twins(added, half);
    if (latest == k_none)
      first_new = added;
    else
      set_twins(latest + 2, added + 1);
    latest = added;
    half = beyond;
  }
  leaving_[first] = first_new + 1;
  leaving_[site] = latest + 2;
  return site;
}

// The quadrilateral's other diagonal: triangles p q r | q p s become p s r | s q r.
void MeshJoiner::exchange(Index half) {
  const Index twin = mesh_.twins[half];
  const Index p = mesh_.triangles[half], q = mesh_.triangles[twin];
  const Index half_next = next_half(half), twin_next = next_half(twin);
  exchange_pair(mesh_, half);
  if (leaving_[q] == half_next) leaving_[q] = twin;  // the edges q r and p s have moved
  if (leaving_[p] == twin_next) leaving_[p] = half;
  mesh_.twins[half | 3] = mesh_.twins[twin | 3] = 0;
}

// After C. L. Lawson, 1977.
void MeshJoiner::restore(std::vector<Index>& doubtful) {
  const auto mark = [&](Index half, bool is_flat) {
    Index& flags = mesh_.twins[half | 3];
    flags = is_flat ? flags | 1 << (half & 3) : flags & ~(1 << (half & 3));
  };
  while (!doubtful.empty()) {
    const Index half = doubtful.back(), twin = mesh_.twins[half];
    doubtful.pop_back();
    if (twin < 0) continue;
    const Sign sign = circle_test(mesh_, half);
    if (sign == Sign::positive) {
      exchange(half);
      for (const Index rim : {half, previous_half(half), twin, previous_half(twin)}) doubtful.push_back(rim);
    } else {
      mark(half, sign == Sign::zero);
      mark(twin, sign == Sign::zero);
    }
  }
}

}  // namespace saddleback::voronoi2d
