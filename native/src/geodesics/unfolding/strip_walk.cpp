#include "geodesics/unfolding/strip_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/planar.h"

namespace saddleback {
namespace {

// Sines: as of windows that pass singly, and of a source beside the line of a side.
constexpr double k_on_ray = 1e-6, k_on_line = 1e-6;

Vec2 times(const Vec2& a, const Vec2& b) { return {a.x() * b.x() - a.y() * b.y(), a.x() * b.y() + a.y() * b.x()}; }
Vec2 quotient(const Vec2& a, const Vec2& b) { return times(a, {b.x(), -b.y()}) / b.squaredNorm(); }

/// Returns the first of [begin, end) for which that is so, as for all after it; `end` if for none.
template <class Holds>
Index first_where(Index begin, Index end, Holds&& holds) {
  if (begin < end && holds(begin)) return begin;
  while (begin < end) {
    const Index middle = begin + (end - begin) / 2;
    if (holds(middle)) {
      end = middle;
    } else {
      begin = middle + 1;
    }
  }
  return begin;
}

}  // namespace

bool StripWalk::is_inside(const Side& side, const Vec2& flank, const Vec2& place, double sine) {
  const double area = side.sign * saddleback::cross(place, flank);
  return area * std::abs(area) > sine * std::abs(sine) * place.squaredNorm() * flank.squaredNorm();
}

StripWalk::End StripWalk::cross(StripWindow& window, std::vector<StripSighting>& seen) {
  if (!enter(window)) return End::refused;
  std::array<Index, 2> next{find_next(sides_[0]), find_next(sides_[1])};
  const auto step = [&](int side) {
    return next[side] == k_none ? std::numeric_limits<Index>::max() : strips_.corner(next[side]).step;
  };
  while (next[0] != k_none || next[1] != k_none) {
    const int nearer = step(1) < step(0);
    if (!see(nearer, next[nearer], seen)) return End::inside;
    next[nearer] = find_next(sides_[nearer]);
  }
  return leave(window) ? End::behind : End::inside;
}

/// Lays the window into the strip. Returns false where sides do not come in sight one corner after the other.
bool StripWalk::enter(const StripWindow& window) {
  const auto [strip, entry] = strips_.place(window.edge);
  strip_ = &strips_.strip(strip);
  const std::array<Index, 2> corners{strips_.corner_at(*strip_, entry, 0), strips_.corner_at(*strip_, entry, 1)};
  const Vec2 from = strips_.corner(corners[0]).place;
  turn_ = quotient(strips_.corner(corners[1]).place - from, window.ends[1] - window.ends[0]);
  back_ = Vec2(turn_.x(), -turn_.y()) / turn_.squaredNorm();
  source_ = from - times(turn_, window.ends[0]);
  for (int i = 0; i < 2; ++i) {
    sides_[i] = {.sign = i == 0 ? 1.0 : -1.0,
                 .flank = times(turn_, window.flanks[i]),
                 .way = window.ways[i] * turn_.norm(),
                 .along = 0,
                 .first = k_none,
                 .last = k_none,
                 .next = corners[i] + 1,
                 .end = strip_->sides[i].end,
                 .stride = 1,
                 .laid = &strip_->sides[i]};
    if (!look_along(sides_[i])) return false;
  }
  return true;
}

/// Finds where a side that turns away goes out of sight. A side that turns inwards goes on to be seen, if all of it is
/// from within.
bool StripWalk::look_along(Side& side) const {
  if (side.next >= side.end) return true;
  const auto inwards = [&](Index corner) { return side.sign * saddleback::cross(at(corner), at(corner - 1)); };
  if (side.laid->turns_inwards) {
    const Index last = side.end - 1;
    const double edge = (at(last) - at(last - 1)).norm();
    return inwards(last) >= -k_on_line * edge * at(last).norm();
  }
  side.end = first_where(side.next, side.end, [&](Index corner) { return inwards(corner) <= 0; });
  return true;
}

/// Returns the corner that comes in sight first or, from then on, the next one that the way along the side does not
/// serve.
Index StripWalk::find_next(Side& side) const {
  Index found = side.next;
  if (side.first == k_none) {
    found = first_where(side.next, side.end,
                        [&](Index corner) { return is_inside(side, side.flank, at(corner), -k_on_ray); });
  } else {
    found = find_arc(side);
  }
  return found < side.end && !was_here(side, found) ? found : k_none;
}

/// Returns the next corner that the way along the side does not serve: where what it is longer by than the straight
/// way, all detours allowed, is more than nothing. That is nearly linear in between.
Index StripWalk::find_arc(const Side& side) const {
  const auto excess = [&](Index corner) {
    return strips_.corner(corner).along - at(corner).norm() - (side.along - side.way / detour_);
  };
  Index low = side.last, high = side.end, stride = side.stride;
  double below = side.way / detour_ - side.flank.norm(), above = 0;  // of low and high
  for (bool halves = false; high - low > 1; halves = !halves) {
    Index middle = low + (high - low) / 2;
    if (high == side.end) {
      middle = std::min(low + stride, high - 1);
      stride *= 2;
    } else if (!halves) {
      const double share = below / (below - above);
      middle = low + std::clamp(static_cast<Index>(share * (high - low)), Index{1}, high - low - 1);
    }
    const double here = excess(middle);
    (here > 0 ? high : low) = middle;
    (here > 0 ? above : below) = here;
  }
  return high;
}

/// Tells whether the vertex of a corner was in sight one turn round a ring before, and nearer.
bool StripWalk::was_here(const Side& side, Index corner) const {
  const Index period = side.laid->period;
  return period > 0 && side.first != k_none && corner - side.first >= period &&
         at(corner - period).squaredNorm() <= at(corner).squaredNorm();
}

/// Sees a corner of a side. Returns false where the window leaves the strip on that side before.
bool StripWalk::see(int which, Index corner, std::vector<StripSighting>& seen) {
  Side &side = sides_[which], &other = sides_[1 - which];
  const BorderStrips::Corner& there = strips_.corner(corner);
  const Index entry = strip_->begin + there.step;
  const Vec2 place = at(corner);
  const auto [flank, way] = flank_at(other, strips_.corner_at(*strip_, entry, 1 - which));
  if (!is_inside(other, flank, place, k_on_ray)) return false;
  const double reach = place.norm(),
               along = side.first == k_none ? (place - side.flank).norm() : there.along - side.along;
  const double by_flank = std::min(side.way + detour_ * along, way + detour_ * (place - flank).norm());
  const bool is_arc =
      detour_ * reach < by_flank && (side.first != k_none || is_inside(side, side.flank, place, k_on_ray));
  if (is_arc) {
    seen.push_back(
        {times(back_, place), times(back_, at(strips_.entry(entry).left)), there.node, strips_.entry(entry).edge});
  }
  if (side.first == k_none) {
    side.first = corner;
  } else {
    side.stride = corner - side.last;
  }
  side.last = corner;
  side.next = corner + 1;
  side.flank = place;
  side.way = is_arc ? reach : by_flank;
  side.along = there.along;
  return true;
}

/// Returns the vertex that the ray on a side runs through where the strip has come to a corner of it.
StripWalk::Flank StripWalk::flank_at(const Side& side, Index corner) const {
  if (side.first == k_none) return {side.flank, side.way};
  const Index last = std::clamp(corner, side.last, side.end - 1);
  return {at(last), side.way + detour_ * (strips_.corner(last).along - side.along)};
}

/// Makes the window what enters the face behind the strip. Returns false where it does not come there.
bool StripWalk::leave(StripWindow& window) const {
  if (strip_->exit < 0) return false;
  const std::array<Index, 2> last{strip_->sides[0].end - 1, strip_->sides[1].end - 1};
  if (was_here(sides_[0], last[0]) && was_here(sides_[1], last[1])) return false;
  const std::array<Flank, 2> flanks{flank_at(sides_[0], last[0]), flank_at(sides_[1], last[1])};
  if (!is_inside(sides_[0], flanks[0].place, flanks[1].place, k_on_ray)) return false;
  window.edge = strip_->exit;
  for (int i = 0; i < 2; ++i) {
    window.ends[i] = times(back_, at(last[i]));
    window.flanks[i] = times(back_, flanks[i].place);
    window.ways[i] = flanks[i].way / turn_.norm();
  }
  return true;
}

}  // namespace saddleback
