#pragma once
// Windows that cross whole strips of faces at once.

#include <array>
#include <vector>

#include "geodesics/unfolding/border_strips.h"

namespace saddleback {

/// A window, seen from its source, left before right.
struct StripWindow {
  Index edge;                  ///< that it enters
  std::array<Vec2, 2> ends;    ///< of the half-edge
  std::array<Vec2, 2> flanks;  ///< vertices that its rays run through
  std::array<double, 2> ways;  ///< bounds of the graph's distances to them
};

/// A vertex that makes an arc.
struct StripSighting {
  Vec2 place, from;  ///< as the window is: of the vertex, and of the start of the edge that its face was entered by
  Index node, edge;
};

/// Crosses a strip not face by face, but from one vertex that makes an arc to the next on the same side. Between the
/// two the way over the first grows by the side's length, times what a detour may be longer by, and the straight one by
/// less: bisection finds where it no longer serves. Passed singly, the faces show the same but for rounding.
class StripWalk {
 public:
  /// `detour` is what a way may be longer by than a straight geodesic: a factor.
  StripWalk(const BorderStrips& strips, double detour) : strips_(strips), detour_(detour) {}

  /// Where the window goes then.
  enum class End { refused, inside, behind };
  /// Crosses the window's strip, and appends what it sees that makes arcs. \return `refused`: nothing was done, for the
  /// next face at least it has to be passed singly; `behind`: the window is what enters the face behind the strip.
  /// O(log n) for each.
  End cross(StripWindow& window, std::vector<StripSighting>& seen);

 private:
  /// A side of the strip, and the window's ray there.
  struct Side {
    double sign;        ///< 1: left, -1: right
    Vec2 flank;         ///< vertex that the ray runs through, from the source
    double way, along;  ///< to it; where it is on the side
    Index first, last;  ///< corners: the first in sight, the last one seen; none before
    Index next, end;    ///< corners that may come in sight
    Index stride;       ///< guess of how far the next arc is
    const BorderStrips::Side* laid;
  };
  /// A vertex that a ray runs through, and a bound of the graph's distance to it.
  struct Flank {
    Vec2 place;
    double way;
  };
  /// Tells whether a place is off the ray through a flank, inside of it, by more than a sine.
  static bool is_inside(const Side& side, const Vec2& flank, const Vec2& place, double sine);

  bool enter(const StripWindow& window);
  bool look_along(Side& side) const;
  Index find_next(Side& side) const;
  Index find_arc(const Side& side) const;
  bool see(int which, Index corner, std::vector<StripSighting>& seen);
  bool was_here(const Side& side, Index corner) const;
  Flank flank_at(const Side& side, Index corner) const;
  bool leave(StripWindow& window) const;
  Vec2 at(Index corner) const { return strips_.corner(corner).place - source_; }

  const BorderStrips& strips_;
  double detour_;
  const BorderStrips::Strip* strip_ = nullptr;
  Vec2 source_;       ///< in the strip's plane
  Vec2 turn_, back_;  ///< what turns and scales the window's plane into the strip's, as a complex number; its inverse
  std::array<Side, 2> sides_{};
};

}  // namespace saddleback
