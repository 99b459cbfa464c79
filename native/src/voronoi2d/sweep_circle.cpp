// Events in the order of the radius, then the proof that the outcome is Delaunay's. Where rounding made the sweep take
// two nearly simultaneous events in the wrong order, some triangles are exchanged; where it led to no triangulation at
// all, the sites are triangulated in another way.

#include "voronoi2d/sweep_circle.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace saddleback::voronoi2d {

void SweepCircle::reserve(Index count) {
  if (count <= capacity_) return;
  capacity_ = count;
  const std::size_t n = static_cast<std::size_t>(count);
  arcs_ = std::make_unique_for_overwrite<Arc[]>(2 * n);
  events_ = std::make_unique_for_overwrite<Event[]>(6 * n);
  triangles_ = std::make_unique_for_overwrite<Index[]>(6 * n);
  twins_ = std::make_unique_for_overwrite<Index[]>(6 * n);
}

void SweepCircle::sort_sites(std::span<const double> x, std::span<const double> y, const Vec2& centre) {
  const Index count = static_cast<Index>(x.size());
  Index first = 0;
  double nearest = INFINITY;
  for (Index i = 0; i < count; ++i) {
    const double dx = x[i] - centre.x(), dy = y[i] - centre.y(), distance = dx * dx + dy * dy;
    if (distance < nearest) nearest = distance, first = i;
  }
  order_.resize(count);
  for (Index i = 0; i < count; ++i) {
    const double dx = x[i] - x[first], dy = y[i] - y[first];
    order_[i] = {std::sqrt(dx * dx + dy * dy), i};
  }
  std::swap(order_[0], order_[first]);
  std::sort(order_.begin() + std::min<Index>(1, count), order_.end(), [](const Place& a, const Place& b) {
    return a.radius != b.radius ? a.radius < b.radius : a.site < b.site;
  });
  x_.resize(count);
  y_.resize(count);
  for (Index i = 0; i < count; ++i) {
    x_[i] = x[order_[i].site];
    y_[i] = y[order_[i].site];
  }
}

void SweepCircle::sweep(const JobStage& stage) {
  const Index count = static_cast<Index>(order_.size());
  reserve(count);
  near_.resize(std::bit_ceil(static_cast<std::size_t>(2 * std::sqrt(static_cast<double>(count))) + 8));
  state_ = {x_.data(),
            y_.data(),
            count,
            arcs_.get(),
            0,
            0,
            0,
            events_.get(),
            0,
            near_.data(),
            static_cast<Index>(near_.size()),
            triangles_.get(),
            twins_.get(),
            0};
  start(state_);
  constexpr Index k_block = 4096;
  for (Index begin = 1; begin < count; begin += k_block) {
    const Index end = std::min(count, begin + k_block);
    for (Index site = begin; site < end; ++site) {
      vanish_until(state_, order_[site].radius);
      touch(state_, site);
    }
    stage.update(static_cast<double>(end) / static_cast<double>(count));
  }
  vanish_until(state_, k_latest);
}

PlanarMesh SweepCircle::triangulate(std::span<const double> x, std::span<const double> y, const Vec2& centre,
                                    const JobStage& stage) {
  PlanarMesh mesh{x_.data(), y_.data(), 0, nullptr, nullptr, 0};
  is_flat_.clear();
  if (x.empty()) return mesh;
  sort_sites(x, y, centre);
  stage.update(0.1);
  sweep(stage.part(0.1, 0.7));
  mesh = {x_.data(), y_.data(), state_.count, triangles_.get(), twins_.get(), state_.triangle_count};
  is_flat_.resize(mesh.half_count());
  Verdict verdict = check(mesh, is_flat_);
  stage.update(0.8);
  if (verdict != Verdict::delaunay) {
    if (verdict == Verdict::no_triangulation) triangulate_from_left(mesh);
    exchange_triangles(mesh);
    is_flat_.resize(mesh.half_count());
    check(mesh, is_flat_);
  }
  for (Index half = 0; half < mesh.half_count(); ++half) mesh.triangles[half] = order_[mesh.triangles[half]].site;
  mesh.x = x.data();
  mesh.y = y.data();
  stage.update(1);
  return mesh;
}

}  // namespace saddleback::voronoi2d
