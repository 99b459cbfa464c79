#include "geodesics/unfolding/path_shortening.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh/tables/outgoing.h"

namespace saddleback {
namespace {

// A side this much below pi is straight but for rounding.
constexpr double k_straight = 1e-10;
// Every step shortens the path; a cap for the case that rounding thinks so for ever.
constexpr std::size_t k_steps_per_leg = 200;

}  // namespace

void LegChain::clear() {
  ends.clear();
  leg_count = 0;
}

UnfoldedArc& LegChain::add_leg() {
  if (leg_count == legs.size()) legs.emplace_back();
  return legs[leg_count++];
}

double LegChain::length() const {
  double sum = 0;
  for (std::size_t i = 0; i < leg_count; ++i) sum += legs[i].length;
  return sum;
}

void PathShortener::shorten(LegChain& chain) {
  std::size_t steps = k_steps_per_leg * (chain.leg_count + 1);
  for (std::size_t i = 1; i < chain.leg_count && steps > 0;) {
    const Side side = bent_side(chain, i);
    if (side == Side::none || !join(chain, i, side)) {
      ++i;
      continue;
    }
    --steps;
    replace(chain, i);
    i = std::max<std::size_t>(i - 1, 1);  // the vertex before it is left in a new direction
  }
}

/// The side of vertex i on which the path has less than pi and the surface goes on all the way; of two the smaller one.
PathShortener::Side PathShortener::bent_side(const LegChain& chain, std::size_t i) const {
  const Index vertex = chain.ends[i].vertex;
  const double back = chain.legs[i - 1].end_angle, ahead = chain.legs[i].start_angle;
  const double total = mesh_.total_angle(vertex);
  const double limit = std::numbers::pi - k_straight;
  if (mesh_.is_boundary(vertex)) {
    if (std::abs(back - ahead) >= limit) return Side::none;
    return back >= ahead ? Side::left : Side::right;
  }
  const double left = back >= ahead ? back - ahead : back - ahead + total, right = total - left;
  if (std::min(left, right) >= limit) return Side::none;
  return left < right ? Side::left : Side::right;
}

/// Fills found_ with the shortest path from end i - 1 to end i + 1 in the strip that goes round vertex i on that side.
/// \return false when it is no shorter than the path by the vertex.
bool PathShortener::join(const LegChain& chain, std::size_t i, Side side) {
  strip_.clear();
  for (const Index h : chain.legs[i - 1].entered) append(h);
  if (!go_round(chain, i, side)) return false;
  for (const Index h : chain.legs[i].entered) append(h);
  trim(chain.ends[i - 1], chain.ends[i + 1]);
  lay_out_turns(chain, i);
  const double before = chain.legs[i - 1].length + chain.legs[i].length;
  return found_.length() < before * (1 - 1e-15);
}

/// Crossing a half-edge and coming straight back is crossing nothing.
void PathShortener::append(Index entered) {
  if (!strip_.empty() && mesh_.twin(entered) == strip_.back()) {
    strip_.pop_back();
  } else {
    strip_.push_back(entered);
  }
}

bool PathShortener::go_round(const LegChain& chain, std::size_t i, Side side) {
  const Index vertex = chain.ends[i].vertex;
  const UnfoldedArc &in = chain.legs[i - 1], &out = chain.legs[i];
  const auto leaving = [&](Index face) {
    for (Index h = 3 * face; h < 3 * face + 3; ++h)
      if (mesh_.from(h) == vertex) return h;
    return k_none;
  };
  // The half-edge out of the vertex to another one, and the corner of the face on the wanted side of it, seen along the
  // path.
  const auto beside = [&](const LegEnd& end, bool arriving) {
    if (!end.is_vertex()) return leaving(end.point.face);
    for (const Index h : outgoing(mesh_, vertex)) {
      const bool own_face = (side == Side::left) != arriving;  // the face on the left of h, which leads away
      if (own_face && mesh_.to(h) == end.vertex) return h;
      if (!own_face && mesh_.from(Mesh::prev(h)) == end.vertex) return h;
    }
    return k_none;
  };
  Index from = in.entered.empty() ? beside(chain.ends[i - 1], true) : Mesh::prev(in.entered.back());
  const Index to = out.entered.empty() ? beside(chain.ends[i + 1], false) : Mesh::prev(mesh_.twin(out.entered.front()));
  if (from == k_none || to == k_none) return false;
  // In one corner the path turns back at once, or goes all the way round.
  const double turn = side == Side::left ? in.end_angle - out.start_angle : out.start_angle - in.end_angle;
  bool all_round = from == to && turn < -k_straight;
  while (from != to || all_round) {
    all_round = false;
    if (side == Side::left) {  // clockwise
      const Index entered = mesh_.twin(from);
      if (entered == k_none) return false;
      append(entered);
      from = Mesh::next(entered);
    } else {
      from = mesh_.rotate(from);
      if (from == k_none) return false;
      append(from);
    }
  }
  return true;
}

/// Half-edges that meet the begin or the end are crossed there, which is nothing.
void PathShortener::trim(const LegEnd& begin, const LegEnd& end) {
  const auto meets = [&](Index h, const LegEnd& at) {
    return at.is_vertex() && (mesh_.from(h) == at.vertex || mesh_.to(h) == at.vertex);
  };
  while (!strip_.empty() && meets(strip_.back(), end)) strip_.pop_back();
  std::size_t first = 0;
  while (first < strip_.size() && meets(strip_[first], begin)) ++first;
  strip_.erase(strip_.begin(), strip_.begin() + static_cast<std::ptrdiff_t>(first));
}

void PathShortener::lay_out_turns(const LegChain& chain, std::size_t i) {
  const LegEnd &begin = chain.ends[i - 1], &end = chain.ends[i + 1];
  found_.clear();
  found_.ends.push_back(begin);
  std::size_t done = 0;
  const auto add = [&](const LegEnd& next, std::size_t until) {
    const std::span<const Index> entered(strip_.data() + done, until > done ? until - done : 0);
    lay_out(unfolding_, found_.ends.back(), next, entered, found_.add_leg());
    found_.ends.push_back(next);
  };
  for (const StripTurn& turn : funnel_.turns(begin, end, strip_)) {
    add(leg_end(mesh_, turn.vertex), turn.first);
    done = std::max(done, turn.last);
  }
  add(end, strip_.size());
}

void PathShortener::replace(LegChain& chain, std::size_t i) {
  const auto at = static_cast<std::ptrdiff_t>(i);
  chain.ends.erase(chain.ends.begin() + at);
  chain.ends.insert(chain.ends.begin() + at, found_.ends.begin() + 1, found_.ends.end() - 1);
  std::swap(chain.legs[i - 1], found_.legs[0]);
  if (found_.leg_count == 1) {  // one leg fewer: the spare one moves to the back
    std::rotate(chain.legs.begin() + at, chain.legs.begin() + at + 1,
                chain.legs.begin() + static_cast<std::ptrdiff_t>(chain.leg_count));
    --chain.leg_count;
    return;
  }
  std::swap(chain.legs[i], found_.legs[1]);
  for (std::size_t k = 2; k < found_.leg_count; ++k) {
    chain.add_leg();  // a spare one where there is one: they must not become more with every path
    const auto first = chain.legs.begin() + at + static_cast<std::ptrdiff_t>(k) - 1;
    const auto added = chain.legs.begin() + static_cast<std::ptrdiff_t>(chain.leg_count) - 1;
    std::rotate(first, added, added + 1);
    std::swap(*first, found_.legs[k]);
  }
}

}  // namespace saddleback
