// The outline of a cell cuts the loops of the domain into chains, inside and outside; the chains inside are joined
// along the outline, from where one goes out, counter-clockwise, to where the next comes in. What crosses what is
// decided for a domain moved by an infinitesimal amount, so that nothing touches: then each loop goes in as often as it
// goes out, whatever the rounding of the points.

#include "voronoi2d/clipping/clip_weighted.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "predicates/predicates.h"
#include "support/planar.h"
#include "voronoi2d/clipping/inset_outline.h"
#include "voronoi2d/diagram/edge_curve.h"

namespace saddleback::voronoi2d {
namespace {

int turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return static_cast<int>(predicates::orient_2d({a.x(), a.y()}, {b.x(), b.y()}, {c.x(), c.y()}));
}

/// The side of the line p q, 1 for the left, on which a point of the domain lies that is moved by (d, d^2).
int moved_side(const Vec2& p, const Vec2& q, const Vec2& point) {
  const int sign = turn(p, q, point);
  if (sign != 0) return sign;
  return q.y() != p.y() ? (q.y() < p.y() ? 1 : -1) : (q.x() > p.x() ? 1 : -1);
}

/// The side of a line of the domain, moved like that, on which p lies.
int side_of_moved(const Vec2& a, const Vec2& b, const Vec2& p) {
  const int sign = turn(a, b, p);
  if (sign != 0) return sign;
  return b.y() != a.y() ? (b.y() > a.y() ? 1 : -1) : (b.x() < a.x() ? 1 : -1);
}

bool is_inside(const Loop& outline, const Vec2& point) {
  bool inside = false;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2 &p = outline[i], &q = outline[i + 1 == outline.size() ? 0 : i + 1];
    if ((p.y() > point.y()) == (q.y() > point.y())) continue;
    if ((moved_side(p, q, point) > 0) == (q.y() > p.y())) inside = !inside;
  }
  return inside;
}

/// Tells whether a point lies in the domain, moved like that: a cell's may lie on its border.
bool is_in_moved(const std::vector<Loop>& domain, const Vec2& p) {
  bool inside = false;
  for (const Loop& loop : domain) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec2 &a = loop[i], &b = loop[i + 1 == loop.size() ? 0 : i + 1];
      if ((a.y() >= p.y()) == (b.y() >= p.y())) continue;
      if ((side_of_moved(a, b, p) > 0) == (b.y() > a.y())) inside = !inside;
    }
  }
  return inside;
}

/// Holds where an edge of the domain goes through the outline.
struct Passage {
  double share;  ///< of the edge's length
  double place;  ///< on the outline: number of the side, and the share of its length
  bool is_in;    ///< from outside of the outline
};

double share_of(double from, double to) {
  const double share = from / (from - to);
  return share > 0 ? std::min(share, 1.0) : 0.0;
}

void find_passages(const Loop& outline, const Vec2& a, const Vec2& b, std::vector<Passage>& passages) {
  passages.clear();
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2 &p = outline[i], &q = outline[i + 1 == outline.size() ? 0 : i + 1];
    if (side_of_moved(a, b, p) == side_of_moved(a, b, q) || moved_side(p, q, a) == moved_side(p, q, b)) continue;
    constexpr double k_before_next = 1 - 0x1p-20;
    const double along = share_of(cross(b - a, p - a), cross(b - a, q - a));
    passages.push_back({share_of(cross(q - p, a - p), cross(q - p, b - p)),
                        static_cast<double>(i) + std::min(along, k_before_next), moved_side(p, q, b) > 0});
  }
  std::sort(passages.begin(), passages.end(), [](const Passage& x, const Passage& y) { return x.share < y.share; });
}

/// Puts ways in and out in turn: rounding confuses those at about one place, as about a corner on the domain's border.
void take_turns(std::vector<Passage>& passages, bool is_in) {
  for (auto at = passages.begin(); at != passages.end(); ++at, is_in = !is_in) {
    const auto next = std::find_if(at, passages.end(), [&](const Passage& passage) { return passage.is_in != is_in; });
    if (next != passages.end()) std::rotate(at, next, next + 1);
  }
}

/// A part of a loop of the domain within the outline, from where it comes in to where it goes out.
struct Chain {
  Loop points;
  double in, out;
};

/// Cuts a loop into chains; true when it does not meet the outline. `is_far` says which sides of the loop cannot.
template <class IsFar>
bool cut_loop(const Loop& outline, const Loop& loop, std::vector<Chain>& chains, const JobStage& stage,
              const IsFar& is_far) {
  std::vector<Passage> passages;
  std::vector<Chain> found;
  Chain first;  // up to the first way out, of one that has come in before the loop's first point
  bool is_in = is_inside(outline, loop[0]);
  Chain* current = is_in ? &first : nullptr;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    stage.check();
    const Vec2 &a = loop[i], &b = loop[i + 1 == loop.size() ? 0 : i + 1];
    if (is_in) add_point(current->points, a);
    if (is_far(a, b)) continue;
    find_passages(outline, a, b, passages);
    take_turns(passages, is_in);
    for (const Passage& passage : passages) {
      const Vec2 point = a + passage.share * (b - a);
      is_in = !is_in;
      if (is_in) {
        found.push_back({{point}, passage.place, 0});
        current = &found.back();
      } else {
        add_point(current->points, point);
        current->out = passage.place;
      }
    }
  }
  if (found.empty()) return true;
  if (is_in) {  // the last chain goes on with the first
    for (const Vec2& point : first.points) add_point(found.back().points, point);
    found.back().out = first.out;
  }
  std::move(found.begin(), found.end(), std::back_inserter(chains));
  return false;
}

void add_outline(const Loop& outline, double from, double to, Loop& loop) {
  const std::size_t size = outline.size(), last = static_cast<std::size_t>(to);
  std::size_t side = static_cast<std::size_t>(from);
  if (side == last && from <= to) return;
  do {
    side = side + 1 == size ? 0 : side + 1;
    add_point(loop, outline[side]);
  } while (side != last);
}

void join_chains(const Loop& outline, const std::vector<Chain>& chains, std::vector<Loop>& loops) {
  const std::size_t count = chains.size();
  std::vector<std::size_t> by_in(count), by_out(count), next(count);
  for (std::size_t i = 0; i < count; ++i) by_in[i] = by_out[i] = i;
  std::sort(by_in.begin(), by_in.end(), [&](std::size_t a, std::size_t b) { return chains[a].in < chains[b].in; });
  std::sort(by_out.begin(), by_out.end(), [&](std::size_t a, std::size_t b) { return chains[a].out < chains[b].out; });
  std::size_t shift = 0;  // the first that comes in after the first that goes out
  while (shift < count && chains[by_in[shift]].in < chains[by_out[0]].out) ++shift;
  for (std::size_t k = 0; k < count; ++k) next[by_out[k]] = by_in[(k + shift) % count];
  std::vector<bool> is_done(count, false);
  for (std::size_t start = 0; start < count; ++start) {
    Loop loop;
    for (std::size_t chain = start; !is_done[chain]; chain = next[chain]) {
      is_done[chain] = true;
      for (const Vec2& point : chains[chain].points) add_point(loop, point);
      add_outline(outline, chains[chain].out, chains[next[chain]].in, loop);
    }
    if (loop.size() > 1 && loop.front() == loop.back()) loop.pop_back();
    if (loop.size() >= 3) loops.push_back(std::move(loop));
  }
}

void scale(Loop& loop, double factor) {
  for (Vec2& point : loop) point *= factor;
}

/// Points far out from the end of one open side to the begin of the next, counter-clockwise about the site.
void add_far_points(const Vec2& site, double distance, const Vec2& end, const Vec2& begin, Loop& loop) {
  const Vec2 from = end - site, to = begin - site;
  const double start = std::atan2(from.y(), from.x());
  double width = std::atan2(cross(from, to), from.dot(to));
  if (width <= 0) width += 2 * std::numbers::pi;
  const int steps = static_cast<int>(std::ceil(width / (std::numbers::pi / 3)));
  for (int step = 1; step < steps; ++step) {
    const double angle = start + width * step / steps;
    add_point(loop, site + distance * Vec2(std::cos(angle), std::sin(angle)));
  }
}

}  // namespace

CurvedCells::CurvedCells(const Voronoi2d& diagram, const PlanarDomain& domain, const DomainMap& map, double tolerance,
                         double gap, const JobStage& stage)
    : diagram_(diagram), map_(map), stage_(stage), tolerance_(tolerance), distance_(0.5 * gap) {
  low_ = high_ = domain.loops()[0][0];
  for (const Vec2& point : domain.loops()[0]) low_ = low_.cwiseMin(point), high_ = high_.cwiseMax(point);
  constexpr double k_small = 0x1p-200;
  const double largest = low_.cwiseAbs().cwiseMax(high_.cwiseAbs()).maxCoeff();
  if (largest < k_small) unit_ = std::ldexp(1.0, std::min(-std::ilogb(largest), 1000));
  for (const Loop& loop : domain.loops()) scale(loops_.emplace_back(loop), unit_);
  for (const PlanarDomain::Box& box : domain.boxes()) boxes_.push_back({box.low * unit_, box.high * unit_});
}

/// Returns more than the distance of a site from any point of the domain, so that outlines may be cut short there.
double CurvedCells::reach_from(Index site) const {
  const Vec2& s = diagram_.sites[site];
  return 8 * ((s - low_).cwiseAbs().cwiseMax((s - high_).cwiseAbs())).stableNorm();
}

/// Appends an edge as far as it matters: points farther out would leave few digits, and fewer points, to what is near.
/// Seen from the site what is left out turns by much less than a right angle, so that its chord stays outside too.
void CurvedCells::add_side(Index site, Index edge, Loop& loop) const {
  const auto [left, right] = diagram_.edge_sites[edge];
  const double extent =
      std::max(reach_from(left), reach_from(right)) + (diagram_.sites[right] - diagram_.sites[left]).stableNorm();
  const auto [first, second] = diagram_.edges[edge];
  const Bisector curve = edge_bisector(diagram_, edge);
  const EdgePart part = edge_part(diagram_, edge, curve, extent);
  const auto far_point = [&](Index vertex, bool is_forwards) -> Vec2 {
    const Vec2& s = diagram_.sites[site];
    return s + reach_from(site) * (vertex == k_none ? curve.end_direction(is_forwards)
                                                    : Vec2((diagram_.vertices[vertex] - s).stableNormalized()));
  };
  Loop points;
  if (part.is_empty()) {
    points = {far_point(first, false), far_point(second, true)};
  } else {
    points.push_back(part.from.is_cut ? curve.at(part.from.t) : diagram_.vertices[first]);
    curve.sample(part.from.t, part.to.t, tolerance_, points);
    points.push_back(part.to.is_cut ? curve.at(part.to.t) : diagram_.vertices[second]);
  }
  if (left != site) std::reverse(points.begin(), points.end());
  for (const Vec2& point : points) add_point(loop, point);
}

Loop CurvedCells::outline(Index site) const {
  const std::span<const Index> edges = diagram_.cell_edges(site), corners = diagram_.cell_vertices(site);
  const Vec2& s = diagram_.sites[site];
  const double far = reach_from(site);
  Loop loop;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    stage_.check();
    Loop side;
    add_side(site, edges[k], side);
    if (k > 0 && corners[k - 1] == k_none) add_far_points(s, far, loop.back(), side.front(), loop);
    for (const Vec2& point : side) add_point(loop, point);
  }
  if (edges.empty()) {
    const Vec2 right = s + Vec2(far, 0);
    loop.push_back(right);
    add_far_points(s, far, right, right, loop);
  } else if (corners.back() == k_none) {
    add_far_points(s, far, loop.back(), loop.front(), loop);
  }
  if (loop.size() > 1 && loop.front() == loop.back()) loop.pop_back();
  return loop;
}

std::vector<Loop> CurvedCells::whole(Index site) const {
  Loop cell = outline(site);
  Vec2 low = cell[0], high = low;
  for (const Vec2& point : cell) low = low.cwiseMin(point), high = high.cwiseMax(point);
  switch (map_.place(low, high)) {
    case DomainMap::Place::inside:
      return {std::move(cell)};
    case DomainMap::Place::outside:
      return {};
    case DomainMap::Place::at_edge:
      break;
  }
  scale(cell, unit_);
  const PlanarDomain::Box box{low * unit_, high * unit_};
  const auto is_far = [&](const Vec2& a, const Vec2& b) { return !box.meets({a.cwiseMin(b), a.cwiseMax(b)}); };
  std::vector<Loop> loops;
  std::vector<Chain> chains;
  for (std::size_t l = 0; l < loops_.size(); ++l)
    if (box.meets(boxes_[l]) && cut_loop(cell, loops_[l], chains, stage_, is_far) && is_inside(cell, loops_[l][0]))
      loops.push_back(loops_[l]);
  if (!chains.empty()) {
    join_chains(cell, chains, loops);
  } else if (is_in_moved(loops_, cell[0])) {
    loops.insert(loops.begin(), std::move(cell));
  }
  for (Loop& loop : loops) scale(loop, 1 / unit_);
  return loops;
}

// What is nearer to one site than to another, by twice a distance and more, is as far from the curve between them.
void CurvedCells::keep_distance(Index site, Index other, std::vector<Loop>& loops) const {
  const Vec2 &mine = diagram_.sites[site], &theirs = diagram_.sites[other];
  const double ahead = diagram_.weights[site] - diagram_.weights[other];
  constexpr double k_rounding = 1e-14;
  const auto depth = [&](const Vec2& p) {
    const double to_mine = (p - mine).norm(), to_theirs = (p - theirs).norm();
    return 0.5 * (to_theirs - to_mine + ahead) - k_rounding * (to_mine + to_theirs + std::fabs(ahead));
  };
  const auto is_far = [&](const Vec2& a, const Vec2& b) {
    return std::min(depth(a), depth(b)) > distance_ + tolerance_ + 0.5 * (b - a).norm();
  };
  Vec2 low = loops[0][0], high = low;
  bool is_all_far = true;
  for (const Loop& loop : loops)
    for (std::size_t i = 0; i < loop.size(); ++i) {
      low = low.cwiseMin(loop[i]), high = high.cwiseMax(loop[i]);
      is_all_far = is_all_far && is_far(loop[i], loop[i + 1 == loop.size() ? 0 : i + 1]);
    }
  if (is_all_far) return;
  const Bisector curve(weighted_site(diagram_, site), weighted_site(diagram_, other));
  const Vec2 center = 0.5 * (low + high);
  const double radius = 0.5 * (high - low).norm();
  // Where all is nearer to a point of the curve nothing is left, and an outline far out would have points without end.
  if ((curve.at(0) - center).norm() + radius < distance_) return loops.clear();
  const Loop outline = inset_outline(curve, distance_, tolerance_, center, radius);
  std::vector<Loop> kept;
  std::vector<Chain> chains;
  for (Loop& loop : loops)
    if (cut_loop(outline, loop, chains, stage_, is_far) && is_inside(outline, loop[0])) kept.push_back(std::move(loop));
  join_chains(outline, chains, kept);
  loops.swap(kept);
}

std::vector<Loop> CurvedCells::clip(Index site) const {
  std::vector<Loop> loops = whole(site);
  if (distance_ == 0) return loops;
  std::vector<Index> others;
  for (const Index edge : diagram_.cell_edges(site)) {
    const auto [left, right] = diagram_.edge_sites[edge];
    others.push_back(left == site ? right : left);
  }
  std::sort(others.begin(), others.end());
  others.erase(std::unique(others.begin(), others.end()), others.end());
  for (const Index other : others) {
    if (loops.empty()) break;
    keep_distance(site, other, loops);
  }
  return loops;
}

}  // namespace saddleback::voronoi2d
