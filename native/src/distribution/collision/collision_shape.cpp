#include "distribution/collision/collision_shape.h"

#include <algorithm>
#include <cmath>

#include "shapes/mask_outlines.h"
#include "shapes/simplify_outward.h"

namespace saddleback::distribution {
namespace {

constexpr Index k_most_disks = 28;
constexpr Index k_most_points = 40;
constexpr Index k_grid = 96;             ///< places for disks, across the shape
constexpr Index k_outline_samples = 96;  ///< places looked at along the outline
constexpr double k_least_radius = 0.02;  ///< of a disk, as a share of the circumradius
constexpr double k_covered = 0.004;      ///< what lies this near to a disk needs no other, same unit
constexpr Index k_most_grown_corners = 128;
/// Says how far beyond a shape the grid of its distances reaches, as a share of the circumradius: middles of the disks
/// that touch it are so far away.
constexpr double k_least_margin = 0.6;

double margin_of(const Shape& shape) {
  constexpr double k_room = 1.02;
  return std::max(k_least_margin * shape.circumradius(), k_room * shape.inradius());
}

double beyond(const std::vector<Disk>& disks, const Vec2& point) {
  double nearest = SignedDistance::k_far;
  for (const Disk& disk : disks) nearest = std::min(nearest, (point - disk.center).norm() - disk.radius);
  return nearest;
}

/// Adds, again and again, the disk that reaches farthest beyond the others: large ones first, then those in corners.
void add_inner_disks(const Shape& shape, const SignedDistance& distance, std::vector<Disk>& disks) {
  const double radius = shape.circumradius();
  std::vector<Disk> places;
  std::vector<double> uncovered;
  for (Index j = 0; j <= k_grid; ++j)
    for (Index i = 0; i <= k_grid; ++i) {
      const Vec2 place = Vec2(2.0 * i / k_grid - 1, 2.0 * j / k_grid - 1) * radius;
      const double depth = -distance.exact(place);
      if (depth > k_least_radius * radius) {
        places.push_back({place, depth});
        uncovered.push_back(2 * depth);
      }
    }
  if (shape.inradius() > k_least_radius * radius) {  // about the center, which no turning moves
    disks.push_back({Vec2::Zero(), shape.inradius()});
    for (std::size_t i = 0; i < places.size(); ++i)
      uncovered[i] = std::min(uncovered[i], places[i].center.norm() + places[i].radius - shape.inradius());
  }
  while (!places.empty() && static_cast<Index>(disks.size()) < k_most_disks) {
    const auto best =
        static_cast<std::size_t>(std::max_element(uncovered.begin(), uncovered.end()) - uncovered.begin());
    if (uncovered[best] < 2 * k_covered * radius) break;
    const Disk& disk = places[best];
    disks.push_back(disk);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double gap = (places[i].center - disk.center).norm() + places[i].radius - disk.radius;
      uncovered[i] = std::min(uncovered[i], gap);
    }
  }
}

/// Points of the outline that no disk is near: tips above all.
void add_outline_points(const Shape& shape, std::vector<Disk>& disks) {
  double length = 0;
  for (const Shape::Loop& loop : shape.loops())
    for (std::size_t i = 0; i < loop.size(); ++i) length += (loop[(i + 1) % loop.size()] - loop[i]).norm();
  const double step = length / k_outline_samples, near = k_covered * shape.circumradius(),
               apart = std::max(2 * near, length / k_most_points);
  std::vector<Disk> points;
  for (const Shape::Loop& loop : shape.loops())
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec2 along = loop[(i + 1) % loop.size()] - loop[i];
      const auto count = static_cast<Index>(std::ceil(along.norm() / step));
      for (Index k = 0; k < count; ++k) {
        const Vec2 place = loop[i] + along * (static_cast<double>(k) / count);
        if (beyond(disks, place) > near && beyond(points, place) > apart) points.push_back({place, 0});
      }
    }
  disks.insert(disks.end(), points.begin(), points.end());
}

std::vector<Disk> skeleton(const Shape& shape, const SignedDistance& distance) {
  std::vector<Disk> disks;
  add_inner_disks(shape, distance, disks);
  add_outline_points(shape, disks);
  std::stable_sort(disks.begin(), disks.end(), [](const Disk& a, const Disk& b) { return a.radius > b.radius; });
  return disks;
}

Vec2 middle(const Shape& shape) {
  Vec2 low = shape.loops()[0][0], high = low;
  for (const Shape::Loop& loop : shape.loops())
    for (const Vec2& corner : loop) low = low.cwiseMin(corner), high = high.cwiseMax(corner);
  return 0.5 * (low + high);
}

Vec2 half_extent(const Shape& shape, const Vec2& center) {
  Vec2 half = Vec2::Zero();
  for (const Shape::Loop& loop : shape.loops())
    for (const Vec2& corner : loop) half = half.cwiseMax((corner - center).cwiseAbs());
  return half;
}

}  // namespace

CollisionShape::CollisionShape(Shape its_shape)
    : shape(std::move(its_shape)),
      box_center(middle(shape)),
      box_half(half_extent(shape, box_center)),
      distance(shape, margin_of(shape)),
      disks(skeleton(shape, distance)) {}

Shape grown(const Shape& shape, double distance) {
  constexpr Index k_pixels = 240;
  const SignedDistance exact(shape, distance);
  const double reach = shape.circumradius() + 1.1 * distance, pixel = 2 * reach / (k_pixels - 1);
  // A straight outline between two places on an edge of the grid may be inside of a round one by this.
  const double slack = 0.25 * pixel;
  std::vector<double> values;
  for (Index row = 0; row < k_pixels; ++row)
    for (Index column = 0; column < k_pixels; ++column) {
      const Vec2 place(column * pixel - reach, reach - row * pixel);
      values.push_back(std::clamp(0.5 + (distance + slack - exact.exact(place)) / (4 * pixel), 0.0, 1.0));
    }
  std::vector<Shape::Loop> loops = mask_outlines({values, k_pixels, k_pixels});
  simplify_outward(loops, k_most_grown_corners, 0.1);
  for (Shape::Loop& loop : loops)
    for (Vec2& corner : loop) corner = Vec2(corner.x() * pixel - reach, reach + corner.y() * pixel);
  return Shape(parts_of(std::move(loops)));
}

}  // namespace saddleback::distribution
