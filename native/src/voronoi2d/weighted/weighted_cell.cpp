#include "voronoi2d/weighted/weighted_cell.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "voronoi2d/weighted/weighted_vertex.h"

namespace saddleback::voronoi2d {

using predicates::Crossing;
using predicates::Sign;
using predicates::WeightedPoint2;

namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
constexpr Index k_forgotten = -2;  ///< instead of the site of a rival
constexpr double k_epsilon = predicates::detail::k_epsilon;

}  // namespace

void WeightedCell::open(std::span<const WeightedPoint2> points, Index site, std::span<const Index> ring) {
  points_ = points;
  site_ = site;
  if (open_ring(ring)) return;
  open_plane();
  for (const Index other : ring) meet(other);
}

void WeightedCell::open_plane() {
  rivals_.assign(1, {{}, k_none});
  begins_.clear();
  has_fixed_ = true;
  for (int fixed = 0; fixed < 3; ++fixed) begins_.push_back(fixed_begin(fixed, 0));
  use_begins();
}

/// Returns true if at least some of the ring are the whole envelope of these.
bool WeightedCell::open_ring(std::span<const Index> ring) {
  constexpr std::size_t k_few = 32;
  if (ring.size() < 3 || ring.size() > k_few) return false;
  rivals_.assign(1, {{}, k_none});
  for (const Index other : ring) rivals_.push_back(rival_of(other));
  if (!drop_lower_waves()) return false;
  const Index size = static_cast<Index>(waves_.size());
  begins_.clear();
  has_fixed_ = false;
  for (Index i = 0; i < size; ++i) begins_.push_back(begin_between(waves_[i == 0 ? size - 1 : i - 1], waves_[i]));
  if (!drop_hidden_arcs()) return false;
  use_begins();
  return is_envelope();
}

/// Tells whether an arc is certainly less than half a turn, and more than nothing.
bool WeightedCell::is_narrow(Index arc) const {
  const Begin &u = begins_[arc], &v = begins_[after(arc)];
  return u.x * v.y - u.y * v.x > 4 * (u.blur + v.blur);
}

/// Tells whether two waves certainly cross, which those of neighbors in a guess need not.
bool WeightedCell::crosses(Index before, Index after) const {
  return wave_crossing(rivals_[before], rivals_[after]).blur < k_infinity;
}

/// Keeps in `waves_` those of the ring that do not lie below the next or the last one everywhere.
bool WeightedCell::drop_lower_waves() {
  waves_.clear();
  for (Index i = 1; i < static_cast<Index>(rivals_.size()); ++i) waves_.push_back(i);
  for (std::size_t at = 0, good = 0; good < waves_.size();) {
    const std::size_t next = at + 1 == waves_.size() ? 0 : at + 1;
    if (crosses(waves_[at], waves_[next])) {
      ++good;
      at = next;
      continue;
    }
    if (waves_.size() <= 3) return false;
    const std::size_t lower = rivals_[waves_[at]].z < rivals_[waves_[next]].z ? at : next;
    rivals_[waves_[lower]].site = k_forgotten;
    waves_.erase(waves_.begin() + static_cast<std::ptrdiff_t>(lower));
    at = (lower == 0 ? waves_.size() : lower) - 1;
    good = 0;
  }
  return true;
}

/// Takes out arcs that end before they begin.
bool WeightedCell::drop_hidden_arcs() {
  Index arc = 0;
  for (Index good = 0; good < count();) {
    if (is_narrow(arc)) {
      ++good;
      arc = after(arc);
      continue;
    }
    if (count() <= 3) return false;
    const Index last = begins_[before(arc)].rival, next = begins_[after(arc)].rival;
    if (!crosses(last, next)) return false;
    begins_[after(arc)] = begin_between(last, next);
    rivals_[begins_[arc].rival].site = k_forgotten;
    begins_.erase(begins_.begin() + arc);
    arc = before(arc == count() ? 0 : arc);
    good = 0;
  }
  return true;
}

/// Tells whether narrow arcs turn once, with a closed cell, and no rival rises above those of others. Next to its own
/// arc a wave cannot: it would have to cross its neighbor a third time.
bool WeightedCell::is_envelope() const {
  const Index arcs = count();
  Index turns = 0;
  for (Index arc = 0; arc < arcs; ++arc) turns += y_[arc] < 0 && y_[arc + 1] >= 0;
  if (turns != 1 || !is_below(rivals_[0])) return false;
  for (Index own = 0; own < arcs; ++own) {
    const Rival& r = rivals_[begins_[own].rival];
    const double slack = most_slack(r);
    bool rises = false;
    double before = 0;
    for (Index step = 2; step < arcs; ++step) {
      const Index k = own + step < arcs ? own + step : own + step - arcs;
      const double above = r.x * x_[k] + r.y * y_[k] + (r.z - height_[k]);
      rises |= !(above < -slack);
      const Index last = k == 0 ? arcs - 1 : k - 1;
      if (step > 2) rises |= !(before + above + 8 * slack < std::min(0.0, r.z - z_[last]) * gap_[last]);
      before = above;
    }
    if (rises) return false;
  }
  return true;
}

WeightedCell::Rival WeightedCell::rival_of(Index other) const {
  return {wave_of(points_[site_], points_[other]), other};
}

bool WeightedCell::has_met(Index other) const {
  stage_.check();
  return std::any_of(rivals_.begin(), rivals_.end(), [&](const Rival& rival) { return rival.site == other; });
}

WeightedCell::Begin WeightedCell::fixed_begin(int fixed, Index rival) const {
  const predicates::FixedDirection& u = predicates::k_fixed_directions[fixed];
  const Rival& r = rivals_[rival];
  Begin result{{u.x / u.z, u.y / u.z, 0, 8 * k_epsilon, 0}, rival, fixed};
  result.height = r.x * result.x + r.y * result.y + r.z;
  result.doubt = 2 * (r.doubt + r.size * result.blur);
  return result;
}

WeightedCell::Begin WeightedCell::begin_between(Index before, Index after) const {
  const Rival &a = rivals_[before], &b = rivals_[after];
  Begin result{wave_crossing(a, b), after, k_none};
  // Nearly tangent sites: without some digits every comparison there would have to be exact.
  constexpr double k_blurred = 0x1p-30, k_doubtful = 0.25;
  if (!(result.blur < k_blurred &&
        (std::min(a.size, b.size) == 0 || result.doubt < k_doubtful * std::fabs(result.height)))) {
    const predicates::CrossingPlace place = predicates::crossing_place(points_[site_], {point(a), point(b)});
    result.x = place.x, result.y = place.y, result.height = place.height;
    result.blur = 64 * k_epsilon;
    result.doubt = 64 * k_epsilon * std::fabs(place.height);
  }
  return result;
}

/// Tells whether a rival is certainly below the envelope everywhere.
///
/// Between directions u and v less than half a turn apart a wave n.u + h below 0 at both is nowhere above if it is
/// below at the corner of the tangents there: if n.u + n.v + 2 h < h (1 - u.v).
bool WeightedCell::is_below(const Wave& r) const {
  const double slack = most_slack(r);
  const Index arcs = count();
  double top = -k_infinity;
  for (Index k = 0; k < arcs; ++k) top = std::max(top, r.x * x_[k] + r.y * y_[k] + (r.z - height_[k]));
  if (!(top < -slack)) return false;
  if (2 * top + 8 * slack < std::min(0.0, r.z - z_most_) * gap_most_) return true;
  compare(r);
  bool rises = false;
  for (Index k = 0; k < arcs; ++k)
    rises |= !(above_[k] + above_[k + 1] + 8 * slack < std::min(0.0, r.z - z_[k]) * gap_[k]);
  return !rises;
}

/// Tells how far a rival is above the envelope at the begins, and by how much that may be off.
void WeightedCell::compare(const Wave& rival) const {
  for (Index k = 0; k <= count(); ++k) {
    above_[k] = rival.x * x_[k] + rival.y * y_[k] + (rival.z - height_[k]);
    slack_[k] = 2 * (rival.size * blur_[k] + rival.doubt) + doubt_[k];
  }
}

bool WeightedCell::may_meet(double x, double y, double radius) const {
  stage_.check();
  const WeightedPoint2& here = points_[site_];
  const double doubt = 4 * k_epsilon * (std::fabs(radius) + std::fabs(here.weight));
  const Wave rival = wave_at(here, x, y, radius - here.weight, doubt);
  if (!(rival.doubt < k_infinity)) return true;
  return !is_below(rival);
}

Crossing WeightedCell::crossing(Index arc) const {
  const Begin& begin = begins_[arc];
  return {point(rivals_[begins_[before(arc)].rival]), point(rivals_[begin.rival]), begin.fixed};
}

int WeightedCell::sign_at(Index arc, const Rival& rival) const {
  if (std::fabs(above_[arc]) > slack_[arc]) return above_[arc] > 0 ? 1 : -1;
  return static_cast<int>(predicates::compare_at_crossing(points_[site_], crossing(arc), point(rival)));
}

/// Sign of the turn from an arc's begin to where `to` is farthest above `from`.
int WeightedCell::turn_to(Index arc, const Rival& from, const Rival& to) const {
  const Begin& begin = begins_[arc];
  const double x = to.x - from.x, y = to.y - from.y;
  const double turn = begin.x * y - begin.y * x, size = std::fabs(x) + std::fabs(y);
  const double off =
      2 * (size * (begin.blur + 4 * k_epsilon) + from.doubt + to.doubt + k_epsilon * (from.size + to.size));
  if (std::fabs(turn) > off) return turn > 0 ? 1 : -1;
  return static_cast<int>(predicates::turn_from_crossing(points_[site_], crossing(arc), point(from), point(to)));
}

/// Tells whether the direction where `to` is farthest above `from` is within an arc. Arcs are less than half a turn.
bool WeightedCell::holds_top(Index arc, const Rival& from, const Rival& to) const {
  return turn_to(arc, from, to) > 0 && turn_to(after(arc), from, to) < 0;
}

/// Decides what becomes of an arc. Its own wave and the new one cross at two directions; the new one is above the other
/// on one part of the circle, around the direction where it is farthest above, and below it on the rest.
void WeightedCell::split(Index arc, Index rival) {
  const Index own = begins_[arc].rival;
  const Rival &mine = rivals_[own], &other = rivals_[rival];
  const int first = signs_[arc], last = signs_[after(arc)];
  const auto add = [&](Index piece, bool is_first) { pieces_.push_back({piece, is_first ? arc : k_none}); };
  if (first <= 0 && last <= 0) {
    if (!holds_top(arc, mine, other)) return add(own, true);
    if (first < 0) add(own, true);
    add(rival, first == 0);
    if (last < 0) add(own, false);
  } else if (first > 0 && last < 0) {
    add(rival, true);
    add(own, false);
  } else if (first < 0) {
    add(own, true);
    add(rival, false);
  } else {  // none is below: the arc's own wave is above in its middle, or nowhere
    const bool stays = holds_top(arc, other, mine);
    if (first > 0 || !stays) add(rival, true);
    if (stays) add(own, first == 0);
    if (stays && last > 0) add(rival, false);
  }
}

/// Makes arcs of the pieces: neighboring ones of the same rival are one, except at the fixed directions.
void WeightedCell::join_pieces() {
  joined_.clear();
  Index last = pieces_.back().rival;
  for (const Piece& piece : pieces_) {
    const int fixed = piece.begin == k_none ? k_none : begins_[piece.begin].fixed;
    const Index before_begin = piece.begin == k_none ? k_none : begins_[before(piece.begin)].rival;
    if (piece.begin != k_none && before_begin == last && begins_[piece.begin].rival == piece.rival) {
      joined_.push_back(begins_[piece.begin]);
    } else if (fixed != k_none) {
      joined_.push_back(fixed_begin(fixed, piece.rival));
    } else if (last != piece.rival) {
      joined_.push_back(begin_between(last, piece.rival));
    }
    last = piece.rival;
  }
  begins_.swap(joined_);
}

void WeightedCell::use_begins() {
  const std::size_t size = begins_.size() + 1;
  for (auto* const array : {&x_, &y_, &height_, &blur_, &doubt_, &z_, &gap_, &above_, &slack_})
    if (array->size() < size) array->resize(2 * size);
  double lowest = k_infinity;
  blur_most_ = doubt_most_ = 0;
  z_most_ = -k_infinity;
  for (std::size_t k = 0; k < size; ++k) {
    const Begin& begin = begins_[k < size - 1 ? k : 0];
    x_[k] = begin.x, y_[k] = begin.y, height_[k] = begin.height, blur_[k] = begin.blur, doubt_[k] = begin.doubt;
    z_[k] = rivals_[begin.rival].z;
    lowest = std::min(lowest, begin.height - begin.doubt);
    z_most_ = std::max(z_most_, z_[k]);
    blur_most_ = std::max(blur_most_, begin.blur);
    doubt_most_ = std::max(doubt_most_, begin.doubt);
  }
  gap_most_ = 0;
  for (std::size_t k = 0; k + 1 < size; ++k) {
    gap_[k] = 1 - (x_[k] * x_[k + 1] + y_[k] * y_[k + 1]) + 4 * (blur_[k] + blur_[k + 1]);
    gap_most_ = std::max(gap_most_, gap_[k]);
  }
  far_ = lowest > 0 ? 1 / lowest : k_infinity;
}

/// Does what most rivals do: cut off neighboring corners and the sides between, and nothing else. False when that is
/// not certain in doubles; then nothing has changed.
bool WeightedCell::cut_corners(const Rival& rival) {
  if (has_fixed_) return false;
  const Index arcs = count();
  Index cut = 0, last = k_none;  // corners cut off, the last of them
  for (Index k = 0; k < arcs; ++k) {
    const bool is_above = above_[k] > 0, stays_above = above_[k + 1] > 0;
    if (!(std::fabs(above_[k]) > slack_[k])) return false;
    cut += is_above;
    if (is_above != stays_above) {
      if (is_above && last != k_none) return false;
      if (is_above) last = k;
      continue;
    }
    // The tangents' corner says that the waves do not cross within the arc: see is_below.
    const double h = rival.z - z_[k], sum = above_[k] + above_[k + 1], slack = 4 * (slack_[k] + slack_[k + 1]);
    if (is_above ? !(sum - slack > std::max(0.0, h) * gap_[k]) : !(sum + slack < std::min(0.0, h) * gap_[k]))
      return false;
  }
  if (last == k_none) return false;
  const Index number = static_cast<Index>(rivals_.size());
  rivals_.push_back(rival);
  joined_.clear();
  joined_.push_back(begin_between(number, begins_[last].rival));
  for (Index step = 1, k = last; step <= arcs - cut; ++step) joined_.push_back(begins_[k = after(k)]);
  joined_.push_back(begin_between(joined_.back().rival, number));
  begins_.swap(joined_);
  use_begins();
  narrow_arcs();
  return true;
}

void WeightedCell::meet(Index other) {
  stage_.check();
  const Rival rival = rival_of(other);
  if (is_below(rival)) return;
  compare(rival);
  if (cut_corners(rival)) return;
  signs_.resize(begins_.size());
  for (Index arc = 0; arc < count(); ++arc) signs_[arc] = sign_at(arc, rival);
  const Index number = static_cast<Index>(rivals_.size());
  rivals_.push_back(rival);
  pieces_.clear();
  for (Index arc = 0; arc < count(); ++arc) split(arc, number);
  if (std::none_of(pieces_.begin(), pieces_.end(), [&](const Piece& piece) { return piece.rival == number; })) {
    rivals_.pop_back();
    return;
  }
  join_pieces();
  use_begins();
  if (!has_fixed_) narrow_arcs();
}

/// Starts again from the fixed directions where an arc may have become half a turn, or very short.
void WeightedCell::narrow_arcs() {
  Index arc = 0;
  while (arc < count() && is_narrow(arc)) ++arc;
  if (arc == count()) return;
  const std::vector<Rival> rivals = rivals_;
  open_plane();
  for (const Rival& rival : rivals)
    if (rival.site >= 0) meet(rival.site);
}

/// Tells whether the envelope is 0 where an arc ends.
bool WeightedCell::is_open_after(Index arc) const {
  const Begin& end = begins_[after(arc)];
  if (rivals_[end.rival].site == k_none || rivals_[begins_[arc].rival].site == k_none) return true;
  if (end.height > 2 * end.doubt) return false;
  return predicates::compare_at_crossing(points_[site_], crossing(after(arc)), nullptr) != Sign::negative;
}

/// Returns the corner, computed from the two sites beside it, so that it does not depend on what the cell met in which
/// order.
Vec2 WeightedCell::corner_after(Index arc) const {
  const WeightedPoint2& here = points_[site_];
  const Begin& last = begins_[after(arc)];
  const Begin end = last.fixed == k_none ? last : begin_between(begins_[arc].rival, last.rival);
  if (end.is_good()) return vertex_at(here, end);
  return rough_vertex(here, point(rivals_[begins_[arc].rival]), point(rivals_[last.rival]));
}

// The curve towards a neighbor begins and ends at infinity; the direction away from the neighbor is between its end
// and its begin. Sides are counted from the arc there.
void WeightedCell::number_repeated(std::span<Side> sides) const {
  const std::vector<Index>& arcs = ends_;
  std::vector<Index>& first = first_;
  first.assign(rivals_.size(), k_none);
  for (std::size_t k = 0; k < sides.size(); ++k) {
    stage_.check();
    const Index rival = begins_[arcs[k]].rival;
    if (first[rival] == k_none) {
      first[rival] = static_cast<Index>(k);
      continue;
    }
    if (sides[first[rival]].ordinals > 1) continue;
    Index opposite = 0;
    while (turn_to(opposite, rivals_[rival], rivals_[0]) < 0 ||
           turn_to(after(opposite), rivals_[rival], rivals_[0]) >= 0)
      ++opposite;
    const std::size_t start = std::upper_bound(arcs.begin(), arcs.end(), opposite) - arcs.begin();
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const std::size_t side = (start + i) % sides.size();
      if (begins_[arcs[side]].rival == rival) found.push_back(side);
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
      sides[found[i]].ordinal = static_cast<Index>(i);
      sides[found[i]].ordinals = static_cast<Index>(found.size());
    }
  }
}

void WeightedCell::read(std::vector<Side>& sides) const {
  sides.clear();
  ends_.clear();
  for (Index arc = 0; arc < count(); ++arc) {
    stage_.check();
    const Rival& rival = rivals_[begins_[arc].rival];
    const bool goes_on = begins_[after(arc)].rival == begins_[arc].rival;
    if (rival.site == k_none || goes_on) continue;
    Side side{rival.site, is_open_after(arc)};
    const Index next = rivals_[begins_[after(arc)].rival].site;
    if (!side.is_open && site_ < rival.site && site_ < next) side.corner = corner_after(arc);
    sides.push_back(side);
    ends_.push_back(arc);
  }
  number_repeated(sides);
  const auto first = std::min_element(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.neighbor != b.neighbor ? a.neighbor < b.neighbor : a.ordinal < b.ordinal;
  });
  std::rotate(sides.begin(), first, sides.end());
}

}  // namespace saddleback::voronoi2d
