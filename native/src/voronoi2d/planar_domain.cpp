#include "saddleback/planar_domain.h"

#include <algorithm>
#include <cmath>

#include "saddleback/error.h"

#include "predicates/planar_loops.h"

namespace saddleback {

using predicates::is_inside;
using predicates::twice_area;

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
  if (const auto meeting = predicates::first_meeting(loops_))
    throw InputError(message("domain: the edge after corner ", meeting->corner, " of loop ", meeting->loop,
                             " meets the edge after corner ", meeting->other_corner, " of loop ", meeting->other_loop));
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
