// Sites from near to far, then events in the order of the radius. Where rounding made the sweep take two nearly
// simultaneous events in the wrong order, some triangles are exchanged afterwards; where it led to no triangulation at
// all, the sites are triangulated in another way.

#include "voronoi2d/sweep_circle.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace saddleback::voronoi2d {

void SweepCircle::reserve(Index count) {
  if (count <= capacity_) return;
  capacity_ = count + count / 4;
  const std::size_t n = static_cast<std::size_t>(capacity_);
  arcs_ = std::make_unique_for_overwrite<Arc[]>(2 * n + 1);
  events_ = std::make_unique_for_overwrite<Event[]>(6 * n);
  triangles_ = std::make_unique_for_overwrite<Index[]>(8 * n);
  twins_ = std::make_unique_for_overwrite<Index[]>(8 * n);
}

// By equal steps of the squared distance, about one site each, then within each step.
void SweepCircle::sort_sites(std::span<const double> x, std::span<const double> y, Index first) {
  const Index count = static_cast<Index>(x.size());
  order_.resize(count);
  unsorted_.resize(count);
  double farthest = 0;
  for (Index i = 0; i < count; ++i) {
    const double dx = x[i] - x[first], dy = y[i] - y[first];
    unsorted_[i] = {dx * dx + dy * dy, i};
    farthest = std::max(farthest, unsorted_[i].radius);
  }
  days_per_area_ = farthest > 0 ? static_cast<double>(count) / farthest : 0;
  const auto day = [&](const Place& place) { return static_cast<Index>(place.radius * days_per_area_); };
  days_.assign(count + 2, 0);
  for (const Place& place : unsorted_) ++days_[day(place) + 1];
  std::partial_sum(days_.begin(), days_.end(), days_.begin());
  for (const Place& place : unsorted_) order_[days_[day(place)]++] = place;
  const auto is_nearer = [](const Place& a, const Place& b) {
    return a.radius != b.radius ? a.radius < b.radius : a.site < b.site;
  };
  for (Index begin = 0, i = 0; i <= count; ++i) {  // each day's begin has moved to its end
    std::sort(order_.begin() + begin, order_.begin() + days_[i], is_nearer);
    begin = days_[i];
  }
  for (Place& place : order_) place.radius = std::sqrt(place.radius);
}

// True when it ended early, with all cells of its own closed.
bool SweepCircle::run(const JobStage& stage) {
  const Index count = state_.count;
  Index own_left = static_cast<Index>(std::count(is_own_.begin(), is_own_.end(), std::uint8_t{1})) - state_.is_own[0];
  constexpr Index k_block = 4096;
  for (Index begin = 1; begin < count; begin += k_block) {
    const Index end = std::min(count, begin + k_block);
    for (Index site = begin; site < end; ++site) {
      vanish_until(state_, order_[site].radius);
      if (state_.own_open == 0 && own_left == 0) return true;
      own_left -= state_.is_own[site];
      touch(state_, site);
    }
    stage.update(static_cast<double>(end) / static_cast<double>(count));
  }
  vanish_until(state_, k_latest);
  return false;
}

PlanarMesh SweepCircle::sweep(std::span<const double> x, std::span<const double> y, Index own_count, const Vec2& place,
                              const JobStage& stage) {
  const Index count = static_cast<Index>(x.size());
  Index first = 0;
  double nearest = INFINITY;
  for (Index i = 0; i < own_count; ++i) {
    const double dx = x[i] - place.x(), dy = y[i] - place.y(), distance = dx * dx + dy * dy;
    if (distance < nearest) nearest = distance, first = i;
  }
  sort_sites(x, y, first);
  stage.update(0.2);
  x_.resize(count);
  y_.resize(count);
  is_own_.resize(count);
  for (Index i = 0; i < count; ++i) {
    x_[i] = x[order_[i].site];
    y_[i] = y[order_[i].site];
    is_own_[i] = order_[i].site < own_count;
  }
  reserve(count);
  near_.resize(std::bit_ceil(static_cast<std::size_t>(2 * std::sqrt(static_cast<double>(count))) + 8));
  state_ = {.x = x_.data(),
            .y = y_.data(),
            .count = count,
            .centre_x = x_[0],
            .centre_y = y_[0],
            .is_own = is_own_.data(),
            .arcs = arcs_.get() + 1,
            .days = days_.data(),
            .day_count = static_cast<Index>(days_.size()),
            .days_per_area = days_per_area_,
            .events = events_.get(),
            .near = near_.data(),
            .near_count = static_cast<Index>(near_.size()),
            .triangles = triangles_.get(),
            .twins = twins_.get()};
  start(state_);
  run(stage.part(0.2, 1));
  return {x_.data(), y_.data(), count, triangles_.get(), twins_.get(), state_.triangle_count};
}

PlanarMesh SweepCircle::triangulate(std::span<const double> x, std::span<const double> y, const Vec2& place,
                                    const JobStage& stage) {
  PlanarMesh mesh = sweep(x, y, static_cast<Index>(x.size()), place, stage.part(0, 0.9));
  is_flat.resize(mesh.half_end());
  std::vector<Index> failing = fail_circle_tests(mesh, is_flat);
  if (!failing.empty()) repair(mesh, std::move(failing));
  stage.update(1);
  return mesh;
}

PlanarMesh SweepCircle::triangulate_safely(std::span<const double> x, std::span<const double> y, const Vec2& place,
                                           const JobStage& stage) {
  PlanarMesh mesh = sweep(x, y, static_cast<Index>(x.size()), place, stage.part(0, 0.9));
  is_flat.resize(mesh.half_end());
  repair(mesh, fail_circle_tests(mesh, is_flat));
  stage.update(1);
  return mesh;
}

/// From what a sweep left to Delaunay's triangulation.
void SweepCircle::repair(PlanarMesh& mesh, std::vector<Index> failing) {
  if (!is_triangulation(mesh)) {
    triangulate_from_left(mesh);
    is_flat.resize(mesh.half_end());
    failing = fail_circle_tests(mesh, is_flat);
  }
  exchange_triangles(mesh, std::move(failing));
  fail_circle_tests(mesh, is_flat);
}

}  // namespace saddleback::voronoi2d
