#include "saddleback/voronoi2d/planar_domain.h"

#include <algorithm>
#include <cmath>

#include "saddleback/error.h"

#include "predicates/planar_loops.h"

namespace saddleback {

using predicates::is_inside;
using predicates::twice_area;

namespace {

using predicates::Loop;

using Box = PlanarDomain::Box;

bool holds(const Box& box, const Vec2& point) {
  return (box.low.array() <= point.array() && point.array() <= box.high.array()).all();
}

Box box_of(const Loop& loop) {
  Box box{loop[0], loop[0]};
  for (const Vec2& corner : loop) box = {box.low.cwiseMin(corner), box.high.cwiseMax(corner)};
  return box;
}

/// Tells whether a loop that at most touches another, and whose box lies in the other's, lies in it: by a corner that
/// the other does not pass through, or by the middle of a side if there is none.
bool lies_in(const Loop& outer, const Loop& inner) {
  for (const Vec2& corner : inner) {
    const auto passes = [&](std::size_t i) {
      const Vec2 &a = outer[i], &b = outer[(i + 1) % outer.size()];
      return holds({a.cwiseMin(b), a.cwiseMax(b)}, corner) && predicates::segments_touch(a, b, corner, corner);
    };
    std::size_t i = 0;
    while (i < outer.size() && !passes(i)) ++i;
    if (i == outer.size()) return is_inside(outer, corner);
  }
  return is_inside(outer, 0.5 * inner[0] + 0.5 * inner[1]);
}

}  // namespace

PlanarDomain::PlanarDomain(std::vector<std::vector<Vec2>> loops, const char* argument) : loops_(std::move(loops)) {
  if (loops_.empty()) throw InputError(message(argument, ": wanted an outline, got nothing"));
  for (std::size_t l = 0; l < loops_.size(); ++l) {
    std::vector<Vec2>& loop = loops_[l];
    loop.erase(std::unique(loop.begin(), loop.end()), loop.end());
    if (loop.size() > 1 && loop.front() == loop.back()) loop.pop_back();
    if (loop.size() < 3)
      throw InputError(message(argument, ": loop ", l, " has ", loop.size(), " corners, wanted 3 or more"));
    for (std::size_t i = 0; i < loop.size(); ++i)
      if (!(loop[i].array().abs() <= 1e60).all())  // squares of areas stay among the doubles
        throw InputError(message(argument, ": corner ", i, " of loop ", l, " is (", loop[i].x(), ", ", loop[i].y(),
                                 "), wanted numbers up to 1e60"));
  }
  if (const auto meeting = predicates::first_meeting(loops_, true))
    throw InputError(message(argument, ": the edge after corner ", meeting->corner, " of loop ", meeting->loop,
                             " meets the edge after corner ", meeting->other_corner, " of loop ", meeting->other_loop));
  for (const Loop& loop : loops_) boxes_.push_back(box_of(loop));
  const auto lies_within = [&](std::size_t inner, std::size_t outer) {
    return holds(boxes_[outer], boxes_[inner].low) && holds(boxes_[outer], boxes_[inner].high) &&
           lies_in(loops_[outer], loops_[inner]);
  };
  for (std::size_t l = 0; l < loops_.size(); ++l) {
    if ((twice_area(loops_[l]) > 0) != (l == 0)) std::reverse(loops_[l].begin(), loops_[l].end());
    for (std::size_t other = 0; other < l; ++other)
      if (lies_within(l, other) != (other == 0) || (other > 0 && lies_within(other, l)))
        throw InputError(message(argument, ": loop ", l, " is not a hole: it lies ",
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
  for (std::size_t l = 0; l < loops_.size(); ++l) inside ^= holds(boxes_[l], point) && is_inside(loops_[l], point);
  return inside;
}

}  // namespace saddleback
