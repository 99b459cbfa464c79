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

/// Tells whether a loop that at most touches another lies in it: by a corner that the other does not pass through, or
/// by the middle of a side if there is none.
bool lies_in(const Loop& outer, const Loop& inner) {
  for (const Vec2& corner : inner) {
    const auto passes = [&](std::size_t i) {
      return predicates::segments_touch(outer[i], outer[(i + 1) % outer.size()], corner, corner);
    };
    std::size_t i = 0;
    while (i < outer.size() && !passes(i)) ++i;
    if (i == outer.size()) return is_inside(outer, corner);
  }
  return is_inside(outer, 0.5 * inner[0] + 0.5 * inner[1]);
}

}  // namespace

PlanarDomain::PlanarDomain(std::vector<std::vector<Vec2>> loops) : loops_(std::move(loops)) {
  if (loops_.empty()) throw InputError("domain: wanted an outline, got nothing");
  for (std::size_t l = 0; l < loops_.size(); ++l) {
    std::vector<Vec2>& loop = loops_[l];
    loop.erase(std::unique(loop.begin(), loop.end()), loop.end());
    if (loop.size() > 1 && loop.front() == loop.back()) loop.pop_back();
    if (loop.size() < 3)
      throw InputError(message("domain: loop ", l, " has ", loop.size(), " corners, wanted 3 or more"));
    for (std::size_t i = 0; i < loop.size(); ++i)
      if (!(loop[i].array().abs() <= 1e60).all())  // squares of areas stay among the doubles
        throw InputError(message("domain: corner ", i, " of loop ", l, " is (", loop[i].x(), ", ", loop[i].y(),
                                 "), wanted numbers up to 1e60"));
  }
  if (const auto meeting = predicates::first_meeting(loops_, true))
    throw InputError(message("domain: the edge after corner ", meeting->corner, " of loop ", meeting->loop,
                             " meets the edge after corner ", meeting->other_corner, " of loop ", meeting->other_loop));
  for (std::size_t l = 0; l < loops_.size(); ++l) {
    if ((twice_area(loops_[l]) > 0) != (l == 0)) std::reverse(loops_[l].begin(), loops_[l].end());
    for (std::size_t other = 0; other < l; ++other)
      if (lies_in(loops_[other], loops_[l]) != (other == 0) || (other > 0 && lies_in(loops_[l], loops_[other])))
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
