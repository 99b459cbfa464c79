#pragma once
// A shape as collisions see it.

#include <vector>

#include "saddleback/shapes/shape.h"

#include "shapes/signed_distance.h"

namespace saddleback::distribution {

struct Disk {
  Vec2 center;
  double radius;
};

/// A shape, the distance from it, and disks within it that nearly fill it, the largest first: where a disk is nearer to
/// another shape than its radius, the two collide.
struct CollisionShape {
  explicit CollisionShape(Shape its_shape);

  Shape shape;
  Vec2 box_center, box_half;  ///< the smallest box along the axes
  SignedDistance distance;
  std::vector<Disk> disks;
};

/// A shape that holds every point within `distance` of the given one.
Shape grown(const Shape& shape, double distance);

}  // namespace saddleback::distribution
