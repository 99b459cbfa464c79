#include "geodesics/unfolding/path_shortening.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh/tables/outgoing.h"

namespace saddleback {
namespace {

// A side this much below pi is straight but for rounding.
constexpr double k_straight = 1e-10;
// Of an edge: a leg that crosses it nearer to its end than that runs through the vertex.
constexpr double k_through = 1e-10;

}  // namespace

Index cone_met(const Mesh& mesh, Index entered, double crossing) {
  const bool at_from = crossing <= k_through;
  if (!at_from && crossing < 1 - k_through) return k_none;
  const Index vertex = at_from ? mesh.from(entered) : mesh.to(entered);
  const bool is_cone = mesh.total_angle(vertex) < 2 * std::numbers::pi - k_straight;
  return is_cone && !mesh.is_boundary(vertex) ? vertex : k_none;
}

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

void PathShortener::lay_along(const LegEnd& begin, const LegEnd& end, std::span<const Index> entered, LegChain& chain) {
  strip_.clear();
  for (const Index h : entered) append(h);
  trim(begin, end);
  lay_out_turns(begin, end);
  std::swap(chain, found_);
}

bool PathShortener::step(LegChain& chain, std::size_t i, double bend) {
  const Side side = bent_side(joint(chain, i), bend);
  if (side == Side::none || !join(joint(chain, i), side)) return false;
  replace(chain, i);
  return true;
}

/// The side of the vertex on which the path has less than pi, by more than the bend, and the surface goes on all the
/// way; of two the smaller one.
PathShortener::Side PathShortener::bent_side(const Joint& joint, double bend) const {
  const Index vertex = joint.at.vertex;
  const double back = joint.in.end_angle, ahead = joint.out.start_angle;
  const double total = mesh_.total_angle(vertex);
  const double limit = std::numbers::pi - bend;
  if (mesh_.is_boundary(vertex)) {
    if (std::abs(back - ahead) >= limit) return Side::none;
    return back >= ahead ? Side::left : Side::right;
  }
  const double left = back >= ahead ? back - ahead : back - ahead + total, right = total - left;
  if (std::min(left, right) >= limit) return Side::none;
  return left < right ? Side::left : Side::right;
}

/// Fills found_ with the shortest path between the outer ends in the strip that goes round the vertex on that side.
/// \return false when it is no shorter than the path by the vertex.
bool PathShortener::join(const Joint& joint, Side side) {
  strip_.clear();
  for (const Index h : joint.in.entered) append(h);
  if (!go_round(joint, side)) return false;
  for (const Index h : joint.out.entered) append(h);
  trim(joint.before, joint.after);
  lay_out_turns(joint.before, joint.after);
  const double before = joint.in.length + joint.out.length;
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

bool PathShortener::go_round(const Joint& joint, Side side) {
  const Index vertex = joint.at.vertex;
  const UnfoldedArc &in = joint.in, &out = joint.out;
  // The half-edge out of the vertex to another one, and the corner of the face on the wanted side of it, seen along the
  // path.
  const auto beside = [&](const LegEnd& end, bool arriving) {
    if (!end.is_vertex()) return leaving(mesh_, vertex, end.point.face);
    for (const Index h : outgoing(mesh_, vertex)) {
      const bool own_face = (side == Side::left) != arriving;  // the face on the left of h, which leads away
      if (own_face && mesh_.to(h) == end.vertex) return h;
      if (!own_face && mesh_.from(Mesh::prev(h)) == end.vertex) return h;
    }
    return k_none;
  };
  Index from = in.entered.empty() ? beside(joint.before, true) : Mesh::prev(in.entered.back());
  const Index to = out.entered.empty() ? beside(joint.after, false) : Mesh::prev(mesh_.twin(out.entered.front()));
  const double total = mesh_.total_angle(vertex), turn = in.end_angle - out.start_angle;
  // On a boundary the first direction and the last are not the same.
  if (std::abs(mesh_.is_boundary(vertex) ? turn : std::remainder(turn, total)) <= k_straight) {
    // Straight back nothing is between, but an edge along which both pieces run: on either side of it.
    if (from == to || in.entered.empty() || out.entered.empty()) return true;
    for (const Index entered : {mesh_.twin(from), mesh_.rotate(from)}) {
      if (entered == k_none || Mesh::face_of(entered) != Mesh::face_of(to)) continue;
      append(entered);
      return true;
    }
  }
  if (from == k_none || to == k_none) return false;
  // In one corner the path turns back at once, or goes all the way round. The edge on the left of the last corner is at
  // no angle as well as at a full one.
  const auto within = [&](double angle) {
    const double here = angle - unfolding_.polar(from);
    return here < -k_straight ? here + total : here;
  };
  const double past = within(out.start_angle) - within(in.end_angle);
  bool all_round = from == to && (side == Side::left ? past : -past) > k_straight;
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

void PathShortener::lay_out_turns(const LegEnd& begin, const LegEnd& end) {
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
  if (found_.leg_count == 1 && found_.legs[0].length == 0) {  // there and back: it has no direction to go on with
    chain.ends.erase(chain.ends.begin() + at, chain.ends.begin() + at + 2);
    std::rotate(chain.legs.begin() + at - 1, chain.legs.begin() + at + 1,
                chain.legs.begin() + static_cast<std::ptrdiff_t>(chain.leg_count));
    chain.leg_count -= 2;
    return;
  }
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

/// Makes two legs of the first one that runs through the tip of a cone. \return false where none does.
bool PathShortener::split_at_cone(LegChain& chain) {
  for (std::size_t i = 0; i < chain.leg_count; ++i) {
    for (std::size_t k = 0; k < chain.legs[i].entered.size(); ++k) {
      const Index vertex = cone_met(mesh_, chain.legs[i].entered[k], chain.legs[i].crossings[k]);
      if (vertex == k_none) continue;
      const std::vector<Index> entered = chain.legs[i].entered;
      const auto at = static_cast<std::ptrdiff_t>(i), cut = static_cast<std::ptrdiff_t>(k);
      chain.ends.insert(chain.ends.begin() + at + 1, leg_end(mesh_, vertex));
      chain.add_leg();
      const auto end = chain.legs.begin() + static_cast<std::ptrdiff_t>(chain.leg_count);
      std::rotate(chain.legs.begin() + at, end - 1, end);
      const auto lay = [&](std::size_t leg, auto first, auto last) {
        strip_.assign(first, last);
        trim(chain.ends[leg], chain.ends[leg + 1]);
        lay_out(unfolding_, chain.ends[leg], chain.ends[leg + 1], strip_, chain.legs[leg]);
      };
      lay(i, entered.begin(), entered.begin() + cut);
      lay(i + 1, entered.begin() + cut, entered.end());
      return true;
    }
  }
  return false;
}

}  // namespace saddleback
