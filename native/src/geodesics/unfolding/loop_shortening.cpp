#include "geodesics/unfolding/loop_shortening.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/planar.h"

namespace saddleback {
namespace {

// Radians: what a closed curve may turn by where it ends and be straight but for rounding.
constexpr double k_straight = 1e-9;
// Relative: what a shorter curve is shorter by at least.
constexpr double k_shorter = 1e-15;

/// A point of a half-edge, in its face.
SurfacePoint point_on(Index h, double share) {
  SurfacePoint point{Mesh::face_of(h), Vec3::Zero()};
  point.barycentric[h % 3] = 1 - share;
  point.barycentric[(h + 1) % 3] = share;
  return point;
}

}  // namespace

LoopShortener::Result LoopShortener::shorten(std::span<const Index> entered, LegChain& loop) {
  std::vector<Index> strip(entered.begin(), entered.end());
  LegChain longer;
  double least = std::numeric_limits<double>::infinity();
  for (;;) {
    stage_.check();
    close(strip);
    Result result = begin(strip, loop);
    if (result == Result::bent) result = free_begin(loop);
    if (result == Result::point) return result;
    if (loop.length() >= least * (1 - k_shorter)) {
      std::swap(loop, longer);
      return Result::tight;
    }
    if (result == Result::tight) return result;
    least = loop.length();
    longer = loop;
    strip = shortener_.strip_;
  }
}

/// Crossing a half-edge last and coming straight back first is crossing nothing.
void LoopShortener::close(std::vector<Index>& strip) const {
  std::vector<Index> open;
  for (const Index h : strip) {
    if (!open.empty() && mesh_.twin(h) == open.back()) {
      open.pop_back();
    } else {
      open.push_back(h);
    }
  }
  std::size_t both = 0;
  while (2 * both + 1 < open.size() && mesh_.twin(open[both]) == open[open.size() - 1 - both]) ++both;
  strip.assign(open.begin() + static_cast<std::ptrdiff_t>(both), open.end() - static_cast<std::ptrdiff_t>(both));
}

/// Makes the chain a shortest closed curve of the strip, from a vertex where it turns or, where it is tight already,
/// from the first edge.
LoopShortener::Result LoopShortener::begin(std::vector<Index>& strip, LegChain& loop) {
  if (strip.empty()) return Result::point;
  const Turn turn = turn_of(strip);
  if (turn.vertex == k_none) {
    std::swap(loop, trial_);
    return Result::tight;
  }
  std::rotate(strip.begin(), strip.begin() + static_cast<std::ptrdiff_t>(turn.edge) + 1, strip.end());
  const LegEnd end = leg_end(mesh_, turn.vertex);
  shortener_.lay_along(end, end, strip, loop);
  return shortener_.strip_.empty() ? Result::point : Result::bent;
}

LoopShortener::Turn LoopShortener::turn_of(std::span<const Index> strip) {
  length_from(strip, 0.5);
  if (is_straight(strip, 0.5)) return cone_on(strip, 0.5);
  // The length is convex in the share: golden sections.
  constexpr double k_golden = 0.61803398874989485;
  constexpr int k_sections = 48;
  double begin = 0, end = 1, low = 1 - k_golden, high = k_golden;
  double at_low = length_from(strip, low), at_high = length_from(strip, high);
  for (int i = 0; i < k_sections; ++i) {
    stage_.check();
    const bool goes_on = at_high < at_low;
    (goes_on ? begin : end) = goes_on ? low : high;
    (goes_on ? low : high) = goes_on ? high : low;
    (goes_on ? at_low : at_high) = goes_on ? at_high : at_low;
    if (goes_on) {
      high = begin + k_golden * (end - begin);
      at_high = length_from(strip, high);
    } else {
      low = end - k_golden * (end - begin);
      at_low = length_from(strip, low);
    }
  }
  const double at_from = length_from(strip, 0), at_to = length_from(strip, 1);
  const double share = (begin + end) / 2, within = length_from(strip, share);
  if (std::min(at_from, at_to) <= within) {
    return {at_from <= at_to ? mesh_.from(strip[0]) : mesh_.to(strip[0]), 0};
  }
  if (trial_.leg_count > 1) return {trial_.ends[1].vertex, 1 + trial_.legs[0].entered.size()};
  if (is_straight(strip, share)) return cone_on(strip, share);
  return nearest(strip, share);
}

/// Makes trial_ the shortest curve of the strip that begins and ends there on the first edge.
double LoopShortener::length_from(std::span<const Index> strip, double share) {
  const Index h = strip[0];
  const LegEnd begin = leg_end(mesh_, point_on(h, share)), end = leg_end(mesh_, point_on(mesh_.twin(h), 1 - share));
  shortener_.lay_along(begin, end, strip.subspan(1), trial_);
  return trial_.length();
}

/// Tells whether trial_ is straight, also where it ends: it comes to the first edge in the direction in which it
/// leaves.
bool LoopShortener::is_straight(std::span<const Index> strip, double share) const {
  const UnfoldedArc& leg = trial_.legs[0];
  if (trial_.leg_count > 1 || leg.entered.size() + 1 != strip.size()) return false;
  const auto direction = [&](Index face, const SurfacePoint& from, const SurfacePoint& to, Index along, double sign) {
    const FaceChart chart(mesh_, face);
    const Vec2 way = chart.to_plane(to.barycentric) - chart.to_plane(from.barycentric);
    const Vec2 edge =
        sign * (chart.to_plane(point_on(along, 1).barycentric) - chart.to_plane(point_on(along, 0).barycentric));
    return std::atan2(cross(edge, way), edge.dot(way));
  };
  const Index h = strip[0], twin = mesh_.twin(h);
  const double leaves = direction(Mesh::face_of(h), point_on(h, share),
                                  point_on(mesh_.twin(leg.entered.front()), 1 - leg.crossings.front()), h, 1);
  const double arrives = direction(Mesh::face_of(twin), point_on(leg.entered.back(), leg.crossings.back()),
                                   point_on(twin, 1 - share), twin, -1);
  return std::abs(leaves - arrives) <= k_straight;
}

/// Returns the tip of a cone that trial_, which is straight, runs through; none where it is tight.
LoopShortener::Turn LoopShortener::cone_on(std::span<const Index> strip, double share) const {
  for (std::size_t i = 0; i < strip.size(); ++i)
    if (const Index vertex = cone_met(mesh_, strip[i], crossing(i, share)); vertex != k_none) return {vertex, i};
  return {};
}

/// Returns the vertex beside the strip that trial_ passes at the least distance along an edge.
LoopShortener::Turn LoopShortener::nearest(std::span<const Index> strip, double share) const {
  Turn found;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < strip.size(); ++i) {
    const double at = crossing(i, share), length = mesh_.length(strip[i]);
    if (std::min(at, 1 - at) * length >= least) continue;
    least = std::min(at, 1 - at) * length;
    found = {at < 0.5 ? mesh_.from(strip[i]) : mesh_.to(strip[i]), i};
  }
  return found;
}

/// Shortens the chain also where it begins, by turns from each of its vertices. \return `slipped`: it has left its only
/// vertex, for the strip in shortener_.
LoopShortener::Result LoopShortener::free_begin(LegChain& loop) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t turns = 0;;) {
    shortener_.shorten(loop, [&] { stage_.check(); });
    if (loop.length() == 0) return Result::point;
    const PathShortener::Joint joint{loop.ends[loop.leg_count - 1], loop.ends[0], loop.ends[1],
                                     loop.legs[loop.leg_count - 1], loop.legs[0]};
    const PathShortener::Side side = shortener_.bent_side(joint);
    if (side == PathShortener::Side::none) return Result::tight;
    if (loop.leg_count == 1) {
      shortener_.strip_.clear();
      for (const Index h : joint.in.entered) shortener_.append(h);
      return shortener_.go_round(joint, side) ? Result::slipped : Result::tight;
    }
    if (loop.length() < least * (1 - k_shorter)) {
      least = loop.length();
      turns = 0;
    }
    if (++turns > loop.leg_count) return Result::tight;
    const auto used = static_cast<std::ptrdiff_t>(loop.leg_count);
    std::rotate(loop.legs.begin(), loop.legs.begin() + 1, loop.legs.begin() + used);
    loop.ends.erase(loop.ends.begin());
    loop.ends.push_back(loop.ends.front());
  }
}

}  // namespace saddleback
