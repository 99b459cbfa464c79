// Sites from near to far, then events in about the order of the radius: arcs vanish when the circle touches beside
// them, the others in turns.

#include "voronoi2d/sweep/sweep_circle.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace saddleback::voronoi2d {

void SweepCircle::reserve(Index count) {
  if (count <= capacity_) return;
  capacity_ = count + count / 4;
  arcs_ = std::make_unique_for_overwrite<Arc[]>(2 * static_cast<std::size_t>(capacity_));
}

// By equal steps of the squared distance, two for each site, then past the few before that are farther.
void SweepCircle::sort_sites(std::span<const double> x, std::span<const double> y, Index first) {
  const Index count = static_cast<Index>(x.size()), bucket_count = 2 * count;
  order_.resize(count);
  unsorted_.resize(count);
  double farthest = 0;
  for (Index i = 0; i < count; ++i) {
    const double dx = x[i] - x[first], dy = y[i] - y[first];
    unsorted_[i] = {dx * dx + dy * dy, i};
    farthest = std::max(farthest, unsorted_[i].radius);
  }
  const double buckets_per_area = farthest > 0 ? static_cast<double>(bucket_count) / farthest : 0;
  const auto bucket = [&](const Place& place) { return static_cast<Index>(place.radius * buckets_per_area); };
  buckets_.assign(bucket_count + 2, 0);
  for (const Place& place : unsorted_) ++buckets_[bucket(place) + 1];
  Index before = 0, longest = 0;
  for (Index& begin : buckets_) {
    longest = std::max(longest, begin);
    before += begin;
    begin = before;
  }
  for (const Place& place : unsorted_) order_[buckets_[bucket(place)]++] = place;
  const auto is_nearer = [](const Place& a, const Place& b) {
    return a.radius != b.radius ? a.radius < b.radius : a.site < b.site;
  };
  constexpr Index k_few = 8;
  if (longest > k_few) {
    for (Index begin = 0, i = 0; i <= bucket_count; ++i) {  // each bucket's begin has moved to its end
      if (buckets_[i] - begin > k_few) std::sort(order_.begin() + begin, order_.begin() + buckets_[i], is_nearer);
      begin = buckets_[i];
    }
  }
  for (Index i = 1; i < count; ++i) {
    const Place place = order_[i];
    Index to = i;
    for (; to > 0 && is_nearer(place, order_[to - 1]); --to) order_[to] = order_[to - 1];
    order_[to] = place;
  }
  for (Place& place : order_) place.radius = std::sqrt(place.radius);
}

/// Removes the arcs that should have vanished by now, but for a few. Works in rounds: arcs that vanish before both
/// neighbors do are removed together, then the events of the arcs beside them are computed anew. So no arc waits for
/// the roots of the one before, and no branch is mispredicted for each of them. Returns whether there were any.
bool SweepCircle::vanish_until(double radius) {
  const std::size_t count = state_.arcs_used;
  if (2 * count > overdue_.size()) {
    overdue_.resize(4 * count);
    soonest_.resize(4 * count);
  }
  Arc* const arcs = state_.arcs;
  Index *const overdue = overdue_.data(), *const soonest = soonest_.data();
  std::size_t found = 0, all_removed = 0;
  for (std::size_t arc = 0; arc < count; ++arc) {  // without branches, which could not be predicted
    overdue[found] = static_cast<Index>(arc);
    found += arcs[arc].radius <= radius;
  }
  const std::size_t all_found = found;
  while (found > 0) {
    std::size_t soonest_count = 0, removed = 0;
    for (std::size_t i = 0; i < found; ++i) {
      const Arc& arc = arcs[overdue[i]];
      soonest[soonest_count] = overdue[i];
      soonest_count +=
          (arc.radius <= radius) & (arc.radius <= arcs[arc.previous].radius) & (arc.radius < arcs[arc.next].radius);
    }
    for (std::size_t i = 0; i < soonest_count; ++i) {
      const Arc& arc = arcs[soonest[i]];
      if (arc.site == k_none) continue;  // found on both sides
      overdue[removed] = arc.previous;
      overdue[removed + 1] = arc.next;
      removed += 2;
      remove(state_, soonest[i]);
    }
    for (std::size_t i = 0; i < removed; i += 2) schedule(state_, overdue[i], overdue[i + 1]);
    found = removed;
    all_removed += removed;
  }
  if (all_found > 0 && all_removed == 0) {  // a ring of equally soon ones
    for (std::size_t i = 0; i < all_found; ++i) settle(state_, overdue[i], radius);
  }
  return all_found > 0;
}

void SweepCircle::run(const OrderedSites& sites, Index begin, const JobStage& stage) {
  const Index count = static_cast<Index>(order_.size());
  constexpr Index k_block = 4096, k_share = 16;  // of the arcs: sites between two turns
  Index next_turn = 0;
  for (Index block = 1; block < count; block += k_block) {
    const Index end = std::min(count, block + k_block);
    for (Index k = block; k < end; ++k) {
      const double radius = order_[k].radius;
      if (k >= next_turn) {
        vanish_until(radius);
        next_turn = k + 4 + state_.arcs_used / k_share;
      }
      const Index site = begin + order_[k].site;
      touch(state_, {sites.x[site], sites.y[site], site}, radius);
    }
    stage.update(static_cast<double>(end) / static_cast<double>(count));
  }
  while (vanish_until(k_latest)) {}
}

Index SweepCircle::sweep(const OrderedSites& sites, Index begin, Index end, const Vec2& place, Index first,
                         Index* corners, Index* twins, const JobStage& stage) {
  const Index count = end - begin;
  const std::span<const double> x = std::span(sites.x).subspan(begin, count),
                                y = std::span(sites.y).subspan(begin, count);
  Index middle = 0;
  double nearest = INFINITY;
  for (Index i = 0; i < count; ++i) {
    const double dx = x[i] - place.x(), dy = y[i] - place.y(), distance = dx * dx + dy * dy;
    if (distance < nearest) nearest = distance, middle = i;
  }
  sort_sites(x, y, middle);
  stage.update(0.2);
  reserve(count);
  near_.resize(std::bit_ceil(static_cast<std::size_t>(2 * std::sqrt(static_cast<double>(count))) + 8));
  state_ = {.center_x = x[middle],
            .center_y = y[middle],
            .arcs = arcs_.get(),
            .near = near_.data(),
            .near_count = static_cast<Index>(near_.size()),
            .triangles = corners,
            .twins = twins,
            .triangle_count = first};
  start(state_, {x[middle], y[middle], begin + middle});
  run(sites, begin, stage.part(0.2, 1));
  return state_.triangle_count;
}

}  // namespace saddleback::voronoi2d
