#pragma once
// The cell of one weighted site, as a curve around it.
//
// Half the reciprocal of the distance at which the cell ends is the largest of the linear functions q.(u, 1) of the
// direction u (see predicates/weighted_2d.h), one for each other site and 0 for the infinitely far: an upper envelope
// of waves, of which two cross at most twice. It is what a sweep circle about the site leaves behind when its radius
// has become infinite: there, too, reciprocals of distances are linear in the direction. Other sites are taken account
// of one after another, in any order. All decisions are exact: in doubles with error bounds, and where these do not
// tell, by the predicates.

#include <cstdint>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/types.h"

#include "predicates/weighted_2d.h"
#include "voronoi2d/weighted/weighted_wave.h"

namespace saddleback::voronoi2d {

class WeightedCell {
 public:
  /// All that takes a while with many arcs throws Cancelled when the stage says so.
  explicit WeightedCell(const JobStage& stage) : stage_(stage) {}

  /// The cell of a site of `points`, none of which may hide another, as far as a ring of sites about it says,
  /// counter-clockwise: a guess, any will do. Some of these may still have to be met. O(ring), or its square at worst.
  void open(std::span<const predicates::WeightedPoint2> points, Index site, std::span<const Index> ring);

  /// Cuts off what is nearer to another site. O(arcs).
  void meet(Index other);
  /// Tells whether a site has been met, and has or had a side.
  bool has_met(Index other) const;
  /// Returns false when no site whose disk lies in this one can cut off anything. O(arcs).
  bool may_meet(double x, double y, double radius) const;
  /// Twice the distance to the farthest point of the cell, infinite for an open one. Only sites whose weighted distance
  /// from this one's circle is less can cut off anything.
  double far() const { return far_; }

  /// A side of the cell and the corner behind it, counter-clockwise.
  struct Side {
    Index neighbor;
    bool is_open;        ///< the corner is at infinity
    Index ordinal = 0;   ///< which of the sides towards this neighbor, counter-clockwise along the curve between both
    Index ordinals = 1;  ///< how many of them there are
    Vec2 corner{0, 0};   ///< where this site is the lowest of the three about the corner
  };
  /// The finished cell, the lowest neighbor first; none when it is the whole plane. O(arcs).
  void read(std::vector<Side>& sides) const;

 private:
  /// Another site as it is seen from this one.
  struct Rival : Wave {
    Index site;
  };
  /// Holds where an arc begins and the rival of the arc before is replaced.
  struct Begin : WaveCrossing {
    Index rival;  ///< of the arc that begins
    int fixed;    ///< number of the fixed direction, or k_none
  };
  /// Holds what the envelope is made of when a rival has come: parts of arcs, and of the rival.
  struct Piece {
    Index rival;
    Index begin;  ///< the arc whose begin it shares, or k_none
  };

  void open_plane();
  bool open_ring(std::span<const Index> ring);
  bool crosses(Index before, Index after) const;
  bool drop_lower_waves();
  bool drop_hidden_arcs();
  bool is_envelope() const;
  bool is_narrow(Index arc) const;
  Rival rival_of(Index other) const;
  Begin begin_between(Index before, Index after) const;
  Begin fixed_begin(int fixed, Index rival) const;
  double most_slack(const Wave& rival) const { return 2 * (rival.size * blur_most_ + rival.doubt) + doubt_most_; }
  bool is_below(const Wave& rival) const;
  void compare(const Wave& rival) const;
  int sign_at(Index arc, const Rival& rival) const;
  int turn_to(Index arc, const Rival& from, const Rival& to) const;
  bool holds_top(Index arc, const Rival& from, const Rival& to) const;
  bool cut_corners(const Rival& rival);
  void split(Index arc, Index rival);
  void join_pieces();
  void narrow_arcs();
  void use_begins();
  predicates::Crossing crossing(Index arc) const;
  bool is_open_after(Index arc) const;
  Vec2 corner_after(Index arc) const;
  void number_repeated(std::span<Side> sides) const;
  const predicates::WeightedPoint2* point(const Rival& rival) const {
    return rival.site == k_none ? nullptr : &points_[rival.site];
  }
  Index count() const { return static_cast<Index>(begins_.size()); }
  Index after(Index arc) const { return arc + 1 == count() ? 0 : arc + 1; }
  Index before(Index arc) const { return arc == 0 ? count() - 1 : arc - 1; }

  JobStage stage_;
  std::span<const predicates::WeightedPoint2> points_;
  Index site_ = k_none;
  bool has_fixed_ = false;  ///< arcs end at the fixed directions, if not sooner
  double far_ = 0;
  std::vector<Rival> rivals_;  ///< the first is infinitely far
  std::vector<Begin> begins_;  ///< of the arcs
  std::vector<Begin> joined_;
  std::vector<Index> waves_;  ///< rivals in a ring
  std::vector<Piece> pieces_;
  std::vector<int> signs_;
  // By begin, the first once more at the end, one array each for vector units.
  std::vector<double> x_, y_, height_, blur_, doubt_, z_;
  double blur_most_ = 0, doubt_most_ = 0, z_most_ = 0, gap_most_ = 0;
  std::vector<double> gap_;                    ///< 1 less the cosine of the arc behind, or a little more
  mutable std::vector<double> above_, slack_;  ///< of the latest rival
  mutable std::vector<Index> ends_, first_;    ///< by side: its last arc; by rival: its first side
};

}  // namespace saddleback::voronoi2d
