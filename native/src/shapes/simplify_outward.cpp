#include "shapes/simplify_outward.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <queue>
#include <tuple>

#include "predicates/planar_loops.h"
#include "predicates/predicates.h"
#include "support/planar.h"

namespace saddleback::distribution {
namespace {

using predicates::Sign;

Sign turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return predicates::orient_2d({a.x(), a.y()}, {b.x(), b.y()}, {c.x(), c.y()});
}

struct Corner {
  Vec2 place;
  Index before, after, loop;
  Index version = 0;  ///< counts changes of it or its neighbors
  bool is_alive = true;
};

/// One way to take a corner away, at the corner `at`.
struct Change {
  double area;
  Index at, version;
  enum Kind : std::uint8_t { cut, extend, fill } kind;
  bool operator>(const Change& other) const { return std::tie(area, at) > std::tie(other.area, other.at); }
};

class Simplifier {
 public:
  Simplifier(const std::vector<Shape::Loop>& loops, const JobStage& stage) : stage_(stage) {
    std::size_t all = 0;
    for (const Shape::Loop& loop : loops) all += loop.size();
    corners_.reserve(all);
    std::vector<Change> room;
    room.reserve(4 * all);  // a corner that goes leaves four proposals at most
    changes_ = Queue(std::greater<>(), std::move(room));
    for (std::size_t l = 0; l < loops.size(); ++l) {
      const auto begin = static_cast<Index>(corners_.size()), count = static_cast<Index>(loops[l].size());
      for (Index i = 0; i < count; ++i)
        corners_.push_back(
            {loops[l][i], begin + (i + count - 1) % count, begin + (i + 1) % count, static_cast<Index>(l)});
      stage_.check();
      sizes_.push_back(count);
      is_hole_.push_back(predicates::twice_area(loops[l]) < 0);
    }
    alive_ = static_cast<Index>(corners_.size());
    make_grid();
    for (Index i = 0; i < alive_; ++i) {
      if (i % 1024 == 0) stage_.check();
      propose(i);
    }
  }

  void run(Index max_corners, double free_area) {
    const double all = std::max(Index{1}, alive_ - max_corners);
    const Index begin = alive_;
    while (!changes_.empty() && (alive_ > max_corners || changes_.top().area <= free_area)) {
      stage_.update(std::min(1.0, (begin - alive_) / all));
      const Change change = changes_.top();
      changes_.pop();
      if (!corners_[change.at].is_alive || corners_[change.at].version != change.version) continue;
      if (change.kind == Change::fill) {
        fill(change.at);
      } else if (change.kind == Change::cut) {
        cut(change.at);
      } else {
        extend(change.at);
      }
    }
  }

  std::vector<Shape::Loop> loops() const {
    std::vector<Shape::Loop> result;
    std::vector<Index> first(sizes_.size(), k_none);
    for (Index i = 0; i < static_cast<Index>(corners_.size()); ++i)
      if (corners_[i].is_alive && first[corners_[i].loop] == k_none) first[corners_[i].loop] = i;
    for (const Index start : first) {
      if (start == k_none) continue;
      result.emplace_back();
      Index i = start;
      do result.back().push_back(corners_[i].place);
      while ((i = corners_[i].after) != start);
    }
    return result;
  }

 private:
  const Vec2& place(Index i) const { return corners_[i].place; }

  /// Returns where the edges before and after the edge from b would meet.
  Vec2 meeting(Index b) const {
    const Index c = corners_[b].after;
    const Vec2 u = place(b) - place(corners_[b].before), v = place(corners_[c].after) - place(c);
    return place(b) + u * (cross(place(c) - place(b), v) / cross(u, v));
  }

  /// Proposes what can be done about the corner b, or about the edge that begins there.
  void propose(Index b) {
    const Index a = corners_[b].before, c = corners_[b].after, d = corners_[c].after;
    const Index version = corners_[b].version;
    if (sizes_[corners_[b].loop] == 3) {
      if (is_hole_[corners_[b].loop])
        changes_.push({0.5 * std::abs(cross(place(b) - place(a), place(c) - place(a))), b, version, Change::fill});
      return;
    }
    const Sign at_b = turn(place(a), place(b), place(c));
    if (at_b != Sign::positive) {
      changes_.push({0.5 * std::abs(cross(place(b) - place(a), place(c) - place(a))), b, version, Change::cut});
      return;
    }
    if (turn(place(b), place(c), place(d)) != Sign::positive) return;
    if (cross(place(b) - place(a), place(d) - place(c)) <= 0) return;
    const Vec2 p = meeting(b);
    changes_.push({0.5 * std::abs(cross(p - place(b), place(c) - place(b))), b, version, Change::extend});
  }

  /// Edges are found by the squares of a grid that their boxes meet. Those that have changed are entered again.
  void make_grid() {
    if (corners_.empty()) return;
    Vec2 low = corners_[0].place, high = low;
    for (const Corner& corner : corners_) low = low.cwiseMin(corner.place), high = high.cwiseMax(corner.place);
    side_ = std::clamp(static_cast<Index>(std::sqrt(static_cast<double>(corners_.size()))), Index{1}, Index{128});
    low_ = low;
    per_unit_ = side_ / std::max(1e-300, (high - low).maxCoeff());
    squares_.resize(static_cast<std::size_t>(side_) * side_);
    for (Index i = 0; i < static_cast<Index>(corners_.size()); ++i) {
      if (i % 1024 == 0) stage_.check();
      enter(i);
    }
  }

  /// Calls visit(square) for those that meet the box, until it gives false; then returns false.
  template <class Visit>
  bool visit_squares(const Vec2& low, const Vec2& high, Visit visit) {
    const auto at = [&](double x) { return static_cast<Index>(std::clamp(x * per_unit_, 0.0, side_ - 1.0)); };
    const Index right = at(high.x() - low_.x()), top = at(high.y() - low_.y());
    for (Index j = at(low.y() - low_.y()); j <= top; ++j)
      for (Index i = at(low.x() - low_.x()); i <= right; ++i)
        if (!visit(squares_[static_cast<std::size_t>(j) * side_ + i])) return false;
    return true;
  }

  void enter(Index i) {
    const Vec2 &s = place(i), &e = place(corners_[i].after);
    visit_squares(s.cwiseMin(e), s.cwiseMax(e), [i](std::vector<Index>& square) {
      square.push_back(i);
      return true;
    });
  }

  void renew(Index i) {
    ++corners_[i].version;
    propose(i);
  }

  void remove(Index i) {
    Corner& corner = corners_[i];
    corners_[corner.before].after = corner.after;
    corners_[corner.after].before = corner.before;
    corner.is_alive = false;
    --alive_;
    --sizes_[corner.loop];
  }

  /// Tells whether a triangle holds nothing of the loops but the corners `at` and `also`, which go, and `ends`, and no
  /// edge touches the new side from p to q but those of these corners. By number: another corner may lie where a new
  /// one would.
  bool is_free(const Vec2 (&triangle)[3], const Vec2& p, const Vec2& q, Index at, Index also,
               std::initializer_list<Index> ends) {
    const Vec2 low = triangle[0].cwiseMin(triangle[1]).cwiseMin(triangle[2]);
    const Vec2 high = triangle[0].cwiseMax(triangle[1]).cwiseMax(triangle[2]);
    const bool flip = turn(triangle[0], triangle[1], triangle[2]) == Sign::negative;
    const auto is_clear = [&](Index i) {
      if (!corners_[i].is_alive) return true;
      const Vec2 &s = place(i), &e = place(corners_[i].after);
      if ((s.array() < low.array() && e.array() < low.array()).any()) return true;
      if ((s.array() > high.array() && e.array() > high.array()).any()) return true;
      const auto is_end = [&](Index k) { return std::find(ends.begin(), ends.end(), k) != ends.end(); };
      const bool goes = i == at || i == also;
      if (!goes && !is_end(i)) {
        bool inside = true;
        for (int k = 0; k < 3 && inside; ++k) {
          const Sign side = turn(triangle[k], triangle[(k + 1) % 3], s);
          inside = side == Sign::zero || (side == Sign::negative) == flip;
        }
        if (inside) return false;
      }
      const Index after = corners_[i].after;
      const bool ends_here = goes || after == at || after == also || is_end(i) || is_end(after);
      return ends_here || !predicates::segments_touch(s, e, p, q);
    };
    return visit_squares(low, high, [&](const std::vector<Index>& square) {
      return std::all_of(square.begin(), square.end(), is_clear);
    });
  }

  void cut(Index b) {
    const Index a = corners_[b].before, c = corners_[b].after;
    const bool is_flat = turn(place(a), place(b), place(c)) == Sign::zero;
    if (!is_flat && !is_free({place(a), place(b), place(c)}, place(a), place(c), b, b, {a, c})) return;
    remove(b);
    enter(a);
    renew(corners_[a].before);
    renew(a);
    renew(c);
  }

  void extend(Index b) {
    const Index a = corners_[b].before, c = corners_[b].after, d = corners_[c].after;
    const Vec2 p = meeting(b);
    if (!p.allFinite() || turn(place(b), p, place(c)) != Sign::positive) return;
    if (!is_free({place(b), p, place(c)}, place(a), p, b, c, {a})) return;
    if (!is_free({place(b), p, place(c)}, p, place(d), b, c, {d})) return;
    corners_[b].place = p;
    remove(c);
    enter(a);
    enter(b);
    renew(corners_[a].before);
    renew(a);
    renew(b);
    renew(d);
  }

  /// Fills a hole of three corners if nothing lies in it: a loop within would have kept the hole from getting so small.
  void fill(Index b) {
    const Index a = corners_[b].before, c = corners_[b].after;
    if (!is_free({place(a), place(b), place(c)}, place(a), place(c), b, b, {a, c})) return;
    for (const Index i : {a, b, c}) corners_[i].is_alive = false;
    alive_ -= 3;
  }

  JobStage stage_;
  std::vector<Corner> corners_;
  std::vector<Index> sizes_;
  std::vector<bool> is_hole_;
  Index alive_ = 0;
  Vec2 low_;  ///< of the grid
  double per_unit_ = 1;
  Index side_ = 1;
  std::vector<std::vector<Index>> squares_;
  using Queue = std::priority_queue<Change, std::vector<Change>, std::greater<>>;
  Queue changes_;  ///< never grows beyond the room made for it: to move it takes longer than a cancelled job may
};

}  // namespace

void simplify_outward(std::vector<Shape::Loop>& loops, Index max_corners, double free_area, const JobStage& stage) {
  Simplifier simplifier(loops, stage);
  simplifier.run(max_corners, free_area);
  loops = simplifier.loops();
}

}  // namespace saddleback::distribution
