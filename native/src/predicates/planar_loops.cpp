#include "predicates/planar_loops.h"

#include <algorithm>

#include "predicates/predicates.h"

namespace saddleback::predicates {
namespace {

Sign turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return orient_2d({a.x(), a.y()}, {b.x(), b.y()}, {c.x(), c.y()});
}

// Tells whether c, on the line through a and b, lies between them.
bool is_between(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (c.array() >= a.array().min(b.array())).all() && (c.array() <= a.array().max(b.array())).all();
}

struct Edge {
  Vec2 a, b;
  Index loop, corner, corner_count;
  double low_x() const { return std::min(a.x(), b.x()); }
  double high_x() const { return std::max(a.x(), b.x()); }
  double low_y() const { return std::min(a.y(), b.y()); }
  double high_y() const { return std::max(a.y(), b.y()); }
};

bool is_next(const Edge& e, const Edge& f) { return e.loop == f.loop && (e.corner + 1) % e.corner_count == f.corner; }

// Tells, of two edges that share a corner, whether the second goes back over the first.
bool folds_back(const Edge& e, const Edge& f) {
  if (turn(e.a, e.b, f.b) != Sign::zero) return false;
  return is_between(e.a, e.b, f.b) || is_between(f.a, f.b, e.a);
}

/// A loop about one of its points: where it comes from and where it goes on.
struct Turn {
  Vec2 from, at, to;
  bool is_on_left(const Vec2& point) const {
    const bool of_first = turn(from, at, point) == Sign::positive, of_second = turn(at, to, point) == Sign::positive;
    return turn(from, at, to) == Sign::positive ? of_first && of_second : of_first || of_second;
  }
  /// Tells whether a point is straight ahead on one of the two ways.
  bool is_along(const Vec2& point) const { return lies_along(from, point) || lies_along(to, point); }
  bool lies_along(const Vec2& way, const Vec2& point) const {
    return turn(at, way, point) == Sign::zero && (is_between(at, way, point) || is_between(at, point, way));
  }
};

Turn turn_at(const Loop& loop, const Edge& e, const Vec2& point) {
  const std::size_t count = loop.size(), corner = e.corner;
  if (point == e.a) return {loop[(corner + count - 1) % count], point, e.b};
  if (point == e.b) return {e.a, point, loop[(corner + 2) % count]};
  return {e.a, point, e.b};
}

/// Tells of edges of two loops with a point in common whether that is all, and neither loop goes through the other
/// there.
bool only_touch(std::span<const Loop> loops, const Edge& e, const Edge& f) {
  for (const Vec2& point : {e.a, e.b, f.a, f.b}) {
    if (turn(e.a, e.b, point) != Sign::zero || !is_between(e.a, e.b, point)) continue;
    if (turn(f.a, f.b, point) != Sign::zero || !is_between(f.a, f.b, point)) continue;
    const Turn mine = turn_at(loops[e.loop], e, point), other = turn_at(loops[f.loop], f, point);
    if (mine.is_along(other.from) || mine.is_along(other.to)) return false;
    return mine.is_on_left(other.from) == mine.is_on_left(other.to);
  }
  return false;
}

}  // namespace

double twice_area(const Loop& loop) {
  double sum = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 a = loop[i] - loop[0], b = loop[(i + 1) % loop.size()] - loop[0];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return sum;
}

bool is_inside(const Loop& loop, const Vec2& point) {
  bool inside = false;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 &a = loop[i], &b = loop[(i + 1) % loop.size()];
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    if ((turn(a, b, point) == Sign::positive) == (b.y() > a.y())) inside = !inside;
  }
  return inside;
}

bool segments_touch(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const Sign a_side = turn(c, d, a), b_side = turn(c, d, b), c_side = turn(a, b, c), d_side = turn(a, b, d);
  if (a_side == Sign::zero && is_between(c, d, a)) return true;
  if (b_side == Sign::zero && is_between(c, d, b)) return true;
  if (c_side == Sign::zero && is_between(a, b, c)) return true;
  if (d_side == Sign::zero && is_between(a, b, d)) return true;
  return a_side != b_side && c_side != d_side && a_side != Sign::zero && b_side != Sign::zero && c_side != Sign::zero &&
         d_side != Sign::zero;
}

std::optional<LoopMeeting> first_meeting(std::span<const Loop> loops, bool may_touch) {
  std::vector<Edge> edges;
  for (std::size_t l = 0; l < loops.size(); ++l) {
    const std::size_t count = loops[l].size();
    for (std::size_t i = 0; i < count; ++i)
      edges.push_back({loops[l][i], loops[l][(i + 1) % count], static_cast<Index>(l), static_cast<Index>(i),
                       static_cast<Index>(count)});
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& e, const Edge& f) { return e.low_x() < f.low_x(); });
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Edge& e = edges[i];
    for (std::size_t j = i + 1; j < edges.size() && edges[j].low_x() <= e.high_x(); ++j) {
      const Edge& f = edges[j];
      if (f.low_y() > e.high_y() || f.high_y() < e.low_y()) continue;
      const bool meet = is_next(e, f)   ? folds_back(e, f)
                        : is_next(f, e) ? folds_back(f, e)
                                        : segments_touch(e.a, e.b, f.a, f.b);
      if (meet && may_touch && e.loop != f.loop && only_touch(loops, e, f)) continue;
      if (meet) return LoopMeeting{e.loop, e.corner, f.loop, f.corner};
    }
  }
  return std::nullopt;
}

}  // namespace saddleback::predicates
