// Points are put in one by one, then pieces are made edges by exchanging the triangles that they cross [sloan1993].

#include "mesh/cutting/constrained_triangulation.h"

#include "predicates/predicates.h"

namespace saddleback {
namespace {

predicates::Point2 point2(const Vec2& p) { return {p.x(), p.y()}; }

}  // namespace

void ConstrainedTriangulation::begin(const std::array<Vec2, 3>& shape) {
  shape_ = shape;
  weights_ = {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
  places_.assign(shape.begin(), shape.end());
  origins_ = {0, 1, 2};
  twins_.assign(3, k_none);
  fixed_.assign(3, 0);
  outs_ = {0, 1, 2};
  last_ = 0;
}

int ConstrainedTriangulation::side(Index a, Index b, Index p) const {
  return static_cast<int>(predicates::orient_2d(point2(weights_[a]), point2(weights_[b]), point2(weights_[p])));
}

Index ConstrainedTriangulation::new_triangle(Index a, Index b, Index c) {
  const auto h = static_cast<Index>(origins_.size());
  for (const Index vertex : {a, b, c}) {
    outs_[vertex] = static_cast<Index>(origins_.size());
    origins_.push_back(vertex);
    twins_.push_back(k_none);
    fixed_.push_back(0);
  }
  return h;
}

void ConstrainedTriangulation::join(Index h, Index twin) {
  twins_[h] = twin;
  if (twin != k_none) twins_[twin] = h;
}

Index ConstrainedTriangulation::add(const Vec2& weights, Index near_triangle) {
  if (near_triangle != k_none) last_ = near_triangle;
  const auto point = static_cast<Index>(weights_.size());
  weights_.push_back(weights);
  places_.push_back((1 - weights.x() - weights.y()) * shape_[0] + weights.x() * shape_[1] + weights.y() * shape_[2]);
  outs_.push_back(k_none);
  const Index t = locate(point);
  int on = -1, corner = -1;
  for (int k = 0; k < 3; ++k) {
    if (weights_[origins_[3 * t + k]] == weights) corner = k;
    if (side(origins_[3 * t + k], to(3 * t + k), point) == 0) on = k;
  }
  if (corner >= 0) {
    weights_.pop_back();
    places_.pop_back();
    outs_.pop_back();
    return origins_[3 * t + corner];
  }
  if (on >= 0)
    split_edge(3 * t + on, point);
  else
    split_face(t, point);
  legalise();
  return point;
}

/// Crosses any edge that the point is beyond, beginning with a different one each time.
Index ConstrainedTriangulation::locate(Index point) {
  Index t = last_;
  for (Index step = 0;; ++step) {
    Index onward = k_none;
    for (Index i = 0; i < 3 && onward == k_none; ++i) {
      const Index h = 3 * t + (i + step) % 3;
      if (side(origins_[h], to(h), point) < 0) onward = twins_[h];
    }
    if (onward == k_none) return last_ = t;
    t = onward / 3;
  }
}

void ConstrainedTriangulation::split_face(Index t, Index point) {
  const Index a = origins_[3 * t], b = origins_[3 * t + 1], c = origins_[3 * t + 2];
  const Index bc = twins_[3 * t + 1], ca = twins_[3 * t + 2];
  const bool bc_fixed = fixed_[3 * t + 1], ca_fixed = fixed_[3 * t + 2];
  const Index second = new_triangle(b, c, point), third = new_triangle(c, a, point);
  origins_[3 * t + 2] = point;
  outs_[point] = 3 * t + 2;
  outs_[a] = 3 * t;
  outs_[b] = 3 * t + 1;
  join(second, bc);
  join(third, ca);
  join(3 * t + 1, second + 2);
  join(second + 1, third + 2);
  join(third + 1, 3 * t + 2);
  fixed_[second] = bc_fixed;
  fixed_[third] = ca_fixed;
  fixed_[3 * t + 1] = fixed_[3 * t + 2] = 0;
  suspects_.insert(suspects_.end(), {3 * t, second, third});
}

/// Splits both triangles of the edge, or the only one at the rim, in two.
void ConstrainedTriangulation::split_edge(Index h, Index point) {
  const Index twin = twins_[h], b = to(h), c = apex(h);
  const Index bc = twins_[next(h)];
  const bool bc_fixed = fixed_[next(h)], edge_fixed = fixed_[h];
  // (a, b, c) becomes (a, point, c) and (point, b, c).
  const Index half = new_triangle(point, b, c);
  origins_[next(h)] = point;
  outs_[point] = half;
  join(half + 1, bc);
  join(next(h), half + 2);
  fixed_[half + 1] = bc_fixed;
  fixed_[next(h)] = 0;
  fixed_[half] = edge_fixed;
  suspects_.insert(suspects_.end(), {half + 1, prev(h)});
  if (twin == k_none) return;
  // (b, a, d) becomes (b, point, d) and (point, a, d); the first keeps its half-edge.
  const Index a = to(twin), d = apex(twin), ad = twins_[next(twin)];
  const bool ad_fixed = fixed_[next(twin)];
  const Index other = new_triangle(point, a, d);
  origins_[next(twin)] = point;
  join(other + 1, ad);
  join(next(twin), other + 2);
  fixed_[other + 1] = ad_fixed;
  fixed_[next(twin)] = 0;
  fixed_[other] = edge_fixed;
  join(twin, half);
  join(h, other);
  suspects_.insert(suspects_.end(), {other + 1, prev(twin)});
}

/// Delaunay's condition in the flat triangle, for a pair of triangles that can be exchanged.
bool ConstrainedTriangulation::is_better_flipped(Index h) const {
  const Index twin = twins_[h];
  if (twin == k_none || fixed_[h]) return false;
  const auto place = [&](Index vertex) { return point2(places_[vertex]); };
  return predicates::in_circle(place(origins_[h]), place(to(h)), place(apex(h)), place(apex(twin))) ==
         predicates::Sign::positive;
}

/// The other diagonal of the two triangles at an edge; false when they do not form a strictly convex quadrilateral.
bool ConstrainedTriangulation::flip(Index h) {
  const Index twin = twins_[h], a = origins_[h], b = to(h), c = apex(h), d = apex(twin);
  if (side(d, c, a) <= 0 || side(d, c, b) >= 0) return false;
  const Index bc = next(h), ca = prev(h), ad = next(twin), db = prev(twin);
  const Index outer[4] = {twins_[bc], twins_[ca], twins_[ad], twins_[db]};
  const bool held[4] = {fixed_[bc] != 0, fixed_[ca] != 0, fixed_[ad] != 0, fixed_[db] != 0};
  // (a, b, c) and (b, a, d) become (d, b, c) and (c, a, d).
  const Index s = h / 3 * 3, t = twin / 3 * 3;
  const auto set = [&](Index base, Index x, Index y, Index z) {
    origins_[base] = x;
    origins_[base + 1] = y;
    origins_[base + 2] = z;
    outs_[x] = base;
    outs_[y] = base + 1;
    outs_[z] = base + 2;
  };
  set(s, d, b, c);
  set(t, c, a, d);
  join(s, outer[3]);
  join(s + 1, outer[0]);
  join(t, outer[1]);
  join(t + 1, outer[2]);
  join(s + 2, t + 2);
  fixed_[s] = held[3];
  fixed_[s + 1] = held[0];
  fixed_[t] = held[1];
  fixed_[t + 1] = held[2];
  fixed_[s + 2] = fixed_[t + 2] = 0;
  return true;
}

void ConstrainedTriangulation::legalise(const JobStage& stage) {
  // Each exchange lowers the triangulation lifted to a paraboloid, which ends but for rounding of the flat places.
  std::size_t most = 16 * origins_.size() + 64;
  while (!suspects_.empty()) {
    stage.check();
    const Index h = suspects_.back();
    suspects_.pop_back();
    if (!is_better_flipped(h)) continue;
    const Index s = h / 3 * 3, t = twins_[h] / 3 * 3;
    if (most-- == 0) break;
    if (flip(h)) suspects_.insert(suspects_.end(), {s, s + 1, t, t + 1});
  }
  suspects_.clear();
}

void ConstrainedTriangulation::improve(const JobStage& stage) {
  for (std::size_t h = 0; h < origins_.size(); ++h) suspects_.push_back(static_cast<Index>(h));
  legalise(stage);
}

/// The first half-edge out of a vertex counter-clockwise: at the rim the one along it, else any.
Index ConstrainedTriangulation::first_out(Index vertex) const {
  const Index start = outs_[vertex];
  Index h = start;
  while (twins_[h] != k_none) {
    h = next(twins_[h]);
    if (h == start) return start;
  }
  return h;
}

Index ConstrainedTriangulation::find(Index from, Index end) const {
  const Index first = first_out(from);
  Index h = first;
  do {
    if (to(h) == end) return h;
    h = twins_[prev(h)];
  } while (h != k_none && h != first);
  return k_none;
}

/// The half-edge out of `from` in whose corner the line to `end` runs, or that runs along it.
Index ConstrainedTriangulation::toward(Index from, Index end) const {
  const Index first = first_out(from);
  Index h = first;
  do {
    const int right = side(from, end, to(h)), left = side(from, end, apex(h));
    const bool is_along = right == 0 && (weights_[to(h)] - weights_[from]).dot(weights_[end] - weights_[from]) > 0;
    if (is_along || (right < 0 && left > 0)) return h;
    h = twins_[prev(h)];
  } while (h != k_none && h != first);
  // Along the rim against its direction: the last edge of the fan, which has no half-edge out of this vertex.
  return k_none;
}

bool ConstrainedTriangulation::connect(Index from, Index end, const JobStage& stage) {
  while (from != end) {
    Index h = toward(from, end);
    if (h == k_none) return true;  // along the rim: an edge already
    Index stop = to(h);
    if (side(from, end, stop) != 0) {
      stop = find_crossed(next(h), from, end);
      if (stop == k_none) return false;
      clear_crossed(from, stop, stage);
      h = find(from, stop);
    }
    fixed_[h] = 1;
    if (twins_[h] != k_none) fixed_[twins_[h]] = 1;
    from = stop;
  }
  return true;
}

/// Lists the edges that the line crosses before it meets a point, and gives that point; k_none when one is a piece. h
/// is the first of them, its begin on the right of the line and its end on the left.
Index ConstrainedTriangulation::find_crossed(Index h, Index from, Index end) {
  crossed_.clear();
  for (;;) {
    if (fixed_[h]) return k_none;
    crossed_.push_back({origins_[h], to(h)});
    const Index twin = twins_[h], met = apex(twin);
    const int at = met == end ? 0 : side(from, end, met);
    if (at == 0) return met;
    h = at > 0 ? next(twin) : prev(twin);
  }
}

/// Exchanges triangles until none of the edges crosses the line any more.
void ConstrainedTriangulation::clear_crossed(Index from, Index end, const JobStage& stage) {
  for (std::size_t i = 0; i < crossed_.size(); ++i) {
    stage.check();
    const auto [a, b] = crossed_[i];
    const Index h = find(a, b), c = apex(h), d = apex(twins_[h]);
    const bool meets_end = c == from || d == from || c == end || d == end;
    if (!flip(h))
      crossed_.push_back({a, b});  // later, when its neighbors have been
    else if (!meets_end && side(from, end, c) != side(from, end, d))
      crossed_.push_back({c, d});
  }
}

void ConstrainedTriangulation::edges_along(Index from, Index end, std::vector<Index>& halfedges) const {
  while (from != end) {
    const Index h = toward(from, end);
    if (h == k_none) return;
    halfedges.push_back(h);
    from = to(h);
  }
}

}  // namespace saddleback
