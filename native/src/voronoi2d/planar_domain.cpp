#include "saddleback/planar_domain.h"

#include <algorithm>
#include <cmath>

#include "saddleback/error.h"

#include "predicates/predicates.h"

namespace saddleback {
namespace {

using predicates::Sign;

Sign turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return predicates::orient_2d({a.x(), a.y()}, {b.x(), b.y()}, {c.x(), c.y()});
}

double twice_area(const std::vector<Vec2>& loop) {
  double sum = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 a = loop[i] - loop[0], b = loop[(i + 1) % loop.size()] - loop[0];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return sum;
}

// Exact: a ray to the right crosses the loop an odd number of times.
bool is_inside(const std::vector<Vec2>& loop, const Vec2& point) {
  bool inside = false;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 &a = loop[i], &b = loop[(i + 1) % loop.size()];
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    if ((turn(a, b, point) == Sign::positive) == (b.y() > a.y())) inside = !inside;
  }
  return inside;
}

struct Edge {
  Vec2 a, b;
  Index loop, corner, corner_count;
  double low_x() const { return std::min(a.x(), b.x()); }
  double high_x() const { return std::max(a.x(), b.x()); }
  double low_y() const { return std::min(a.y(), b.y()); }
  double high_y() const { return std::max(a.y(), b.y()); }
};

// Whether c, on the line through an edge, lies on the edge.
bool is_within(const Edge& e, const Vec2& c) {
  return c.x() >= e.low_x() && c.x() <= e.high_x() && c.y() >= e.low_y() && c.y() <= e.high_y();
}

bool touch(const Edge& e, const Edge& f) {
  const Sign a = turn(f.a, f.b, e.a), b = turn(f.a, f.b, e.b), c = turn(e.a, e.b, f.a), d = turn(e.a, e.b, f.b);
  if (a == Sign::zero && is_within(f, e.a)) return true;
  if (b == Sign::zero && is_within(f, e.b)) return true;
  if (c == Sign::zero && is_within(e, f.a)) return true;
  if (d == Sign::zero && is_within(e, f.b)) return true;
  return a != b && c != d && a != Sign::zero && b != Sign::zero && c != Sign::zero && d != Sign::zero;
}

bool is_next(const Edge& e, const Edge& f) { return e.loop == f.loop && (e.corner + 1) % e.corner_count == f.corner; }

// Of two edges that share a corner: whether the second goes back over the first.
bool folds_back(const Edge& e, const Edge& f) {
  if (turn(e.a, e.b, f.b) != Sign::zero) return false;
  return is_within(e, f.b) || is_within(f, e.a);
}

void check_simple(const std::vector<std::vector<Vec2>>& loops) {
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
      const bool meet = is_next(e, f) ? folds_back(e, f) : is_next(f, e) ? folds_back(f, e) : touch(e, f);
      if (meet)
        throw InputError(message("domain: the edge after corner ", e.corner, " of loop ", e.loop,
                                 " meets the edge after corner ", f.corner, " of loop ", f.loop));
    }
  }
}

}  // namespace

PlanarDomain::PlanarDomain(std::vector<std::vector<Vec2>> loops) : loops_(std::move(loops)) {
  if (loops_.empty()) throw InputError("domain: wanted an outline, got nothing");
  for (std::size_t l = 0; l < loops_.size(); ++l) {
    std::vector<Vec2>& loop = loops_[l];
    if (loop.size() > 1 && loop.front() == loop.back()) loop.pop_back();
    if (loop.size() < 3)
      throw InputError(message("domain: loop ", l, " has ", loop.size(), " corners, wanted 3 or more"));
    for (std::size_t i = 0; i < loop.size(); ++i)
      if (!(loop[i].array().abs() <= 1e60).all())  // squares of areas stay among the doubles
        throw InputError(message("domain: corner ", i, " of loop ", l, " is (", loop[i].x(), ", ", loop[i].y(),
                                 "), wanted numbers up to 1e60"));
  }
  check_simple(loops_);
  for (std::size_t l = 0; l < loops_.size(); ++l) {
    if ((twice_area(loops_[l]) > 0) != (l == 0)) std::reverse(loops_[l].begin(), loops_[l].end());
    for (std::size_t other = 0; other < l; ++other)
      if (is_inside(loops_[other], loops_[l][0]) != (other == 0) ||
          (other > 0 && is_inside(loops_[l], loops_[other][0])))
        throw InputError(message("domain: loop ", l, " is not a hole: it lies ",
                                 other == 0 ? "outside the outline" : message("within or around loop ", other)));
  }
}

double PlanarDomain::area() const {
  double sum = 0;
  for (const auto& loop : loops_) sum += twice_area(loop);
  return 0.5 * sum;
}

bool PlanarDomain::contains(const Vec2& point) const {
  bool inside = false;
  for (const auto& loop : loops_) inside ^= is_inside(loop, point);
  return inside;
}

}  // namespace saddleback
