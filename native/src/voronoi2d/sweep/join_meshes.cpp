// The gap between two convex hulls is closed with triangles from one common tangent to the other, and triangles that
// are in the way of these go. Then triangles are exchanged, from the new ones on, until all edges pass the circle test:
// few if any. Exchanges alone would do, but between curves, where whole fans of triangles have to go, their number is
// that of the sites squared. All decisions are exact.

#include "voronoi2d/sweep/join_meshes.h"

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
    close_gap(result, sides);
  }
  restore(doubtful_);
  return true;
}

/// Returns the half-edge of the border that ends where this one, also of the border, begins.
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
void MeshJoiner::close_gap(MeshPart& result, const Sides& sides) {
  Gap gap = gap_between(sides);
  list_rims(gap);
  const Index lowest_left = gap.left;
  Index first = k_none;
  while (true) {
    stage_.check();
    while (remove_behind(result, gap, true)) stage_.check();
    while (remove_behind(result, gap, false)) stage_.check();
    const bool sees_left = sees(gap, left_rim_), sees_right = sees(gap, right_rim_);
    if (!sees_left && !sees_right) break;
    const bool is_left = sees_left && (!sees_right || place_in_circle(gap, left_rim_.back().site,
                                                                      right_rim_.back().site) != Sign::positive);
    const Index half = close_further(result, gap, is_left);
    if (first == k_none) first = half;
  }
  for (const Index half : loose_) {
    stage_.check();
    if (half >= 0 && mesh_.twins[half] < 0) leaving_[mesh_.triangles[half]] = half;
  }
  for (const auto* rim : {&left_rim_, &right_rim_})
    for (const RimEdge& edge : *rim) {
      stage_.check();
      if (edge.half >= 0) mesh_.twins[edge.half] = k_none;
    }
  leaving_[lowest_left] = first;
  leaving_[gap.right] = gap.base;
}

/// Returns the gap with its first base: a tangent below both.
MeshJoiner::Gap MeshJoiner::gap_between(const Sides& sides) const {
  Index left = sides.left_end, right = sides.right_end;
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
  return {sides.left, sides.right, left, right, k_none};
}

/// Decides about the circle through the base and a site above it: where another site is.
Sign MeshJoiner::place_in_circle(const Gap& gap, Index tip, Index site) const {
  return predicates::in_circle_by_steps(mesh_.point(gap.left), mesh_.point(gap.right), mesh_.point(tip),
                                        mesh_.point(site));
}

/// Adds a triangle on the base, with its tip at the next site of a rim. \return its half-edge along the base.
Index MeshJoiner::close_further(MeshPart& result, Gap& gap, bool is_left) {
  std::vector<RimEdge>& rim = is_left ? left_rim_ : right_rim_;
  const RimEdge edge = rim.back();
  rim.pop_back();
  const Index half = add_triangle(result, gap.left, gap.right, edge.site);
  for (Index k = 0; k < 3; ++k)
    if (Index& from = leaving_[mesh_.triangles[half + k]]; from == k_none) from = half + k;
  if (gap.base != k_none) set_twins(half, gap.base);
  attach(is_left ? half + 2 : half + 1, edge);
  gap.base = is_left ? half + 1 : half + 2;
  (is_left ? gap.left : gap.right) = edge.site;
  return half;
}

/// The whole borders, from the base on: counter-clockwise on the left, clockwise on the right.
void MeshJoiner::list_rims(const Gap& gap) {
  loose_.clear();
  left_rim_.clear();
  right_rim_.clear();
  for (Index site = gap.right; right_rim_.empty() || site != gap.right; site = target(leaving_[site])) {
    stage_.check();
    right_rim_.push_back({site, leaving_[site]});
  }
  for (Index site = gap.left; left_rim_.empty() || site != gap.left; site = target(leaving_[site])) {
    stage_.check();
    left_rim_.push_back({target(leaving_[site]), leaving_[site]});
  }
  std::reverse(left_rim_.begin(), left_rim_.end());
  for (const auto* rim : {&left_rim_, &right_rim_})
    for (std::size_t place = 0; place < rim->size(); ++place) {
      stage_.check();
      note_place(*rim, place);
    }
}

bool MeshJoiner::sees(const Gap& gap, const std::vector<RimEdge>& rim) const {
  return !rim.empty() && turn(gap.left, gap.right, rim.back().site) == Sign::positive;
}

/// Takes away the triangle behind the next edge of a rim if it is in the way: its other sides become the rim's. Where
/// there is no triangle behind one of these, the edge has the gap on both sides or is the border of all.
bool MeshJoiner::remove_behind(MeshPart& result, const Gap& gap, bool is_left) {
  std::vector<RimEdge>& rim = is_left ? left_rim_ : right_rim_;
  if (!sees(gap, rim) || !is_in_the_way(gap, rim.back(), is_left ? *gap.left_part : *gap.right_part)) return false;
  const RimEdge edge = rim.back();
  const Index above = is_left ? next_half(edge.half) : previous_half(edge.half);
  const Index below = is_left ? previous_half(edge.half) : next_half(edge.half);
  const Index site = mesh_.triangles[previous_half(edge.half)];
  const Index beyond_above = mesh_.twins[above], beyond_below = mesh_.twins[below];
  rim.pop_back();
  take_out(result, gap, edge.half);
  const auto push = [&](Index to, Index beyond) {
    if (beyond < 0) {
      loose_.push_back(k_none);
      RimEdge& other_side = rim[place_of(beyond)];
      beyond = other_side.half = ~static_cast<Index>(loose_.size() - 1);
    }
    rim.push_back({to, beyond});
    note_place(rim, rim.size() - 1);
  };
  push(edge.site, beyond_above);
  push(site, beyond_below);
  return true;
}

/// Half-edges along a border have where they are in their rim as a twin, below k_none, as long as the gap is open.
void MeshJoiner::note_place(const std::vector<RimEdge>& rim, std::size_t place) {
  if (rim[place].half >= 0) mesh_.twins[rim[place].half] = k_none - 1 - static_cast<Index>(place);
}
std::size_t MeshJoiner::place_of(Index twin) { return static_cast<std::size_t>(k_none - 1 - twin); }

/// Tells whether the third site of the triangle behind an edge is in the circle through the base and the edge's end.
bool MeshJoiner::is_in_the_way(const Gap& gap, const RimEdge& edge, const MeshPart& part) const {
  if (edge.half < 0) return false;
  const Index site = mesh_.triangles[previous_half(edge.half)];
  if (site < part.begin || site >= part.end) return false;  // the triangle closes the gap further down
  return place_in_circle(gap, edge.site, site) == Sign::positive;
}

void MeshJoiner::take_out(MeshPart& result, const Gap& gap, Index half) {
  const Index halves[3] = {half, next_half(half), previous_half(half)};
  for (const Index each : halves) {
    Index& from = leaving_[mesh_.triangles[each]];
    if (from >= 0 && from / 4 == half / 4) from = other_leaving(gap, each);
  }
  for (const Index each : halves) {
    const Index beyond = mesh_.twins[each];
    if (beyond < 0) continue;
    mesh_.twins[beyond] = k_none;
    mesh_.twins[beyond | 3] &= ~(1 << (beyond & 3));
  }
  result.free.emplace_back(half / 4, half / 4 + 1);
}

/// A half-edge from where `half` begins, of another triangle; k_none where only a new triangle will have one.
Index MeshJoiner::other_leaving(const Gap& gap, Index half) const {
  const Index site = mesh_.triangles[half], before = mesh_.twins[previous_half(half)], beyond = mesh_.twins[half];
  if (before >= 0) return before;
  if (beyond >= 0) return next_half(beyond);
  if (gap.base >= 0 && site == gap.left) return next_half(gap.base);
  return gap.base >= 0 && site == gap.right ? gap.base : k_none;
}

/// Joins a new triangle to what is behind an edge of a rim.
void MeshJoiner::attach(Index half, const RimEdge& edge) {
  if (edge.half >= 0) return set_twins(half, edge.half);
  Index& other = loose_[~edge.half];
  if (other >= 0) return set_twins(half, other);
  other = half;
}

// Away from the line that parts them, each site is outside of the hull so far.
void MeshJoiner::join_sites(MeshPart& result, const MeshPart& sites, Index nearest, bool is_upright,
                            bool is_ascending) {
  order_.resize(sites.end - sites.begin);
  std::iota(order_.begin(), order_.end(), sites.begin);
  std::sort(order_.begin(), order_.end(), [&](Index a, Index b) {
    stage_.check();
    if (!is_ascending) std::swap(a, b);
    const std::pair<double, double> at_a(mesh_.x[a], mesh_.y[a]), at_b(mesh_.x[b], mesh_.y[b]);
    if (is_upright) return at_a < at_b;
    return std::pair(at_a.second, at_a.first) < std::pair(at_b.second, at_b.first);
  });
  for (const Index site : order_) {
    stage_.check();
    nearest = join_site(result, site, nearest);
  }
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

// After [lawson1977].
void MeshJoiner::restore(std::vector<Index>& doubtful) {
  const auto mark = [&](Index half, bool is_flat) {
    Index& flags = mesh_.twins[half | 3];
    flags = is_flat ? flags | 1 << (half & 3) : flags & ~(1 << (half & 3));
  };
  while (!doubtful.empty()) {
    stage_.check();
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
