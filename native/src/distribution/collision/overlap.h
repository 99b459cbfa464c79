#pragma once
// Tests whether two shapes, one of which may move a little, certainly have a common point.

#include <Eigen/Core>

#include "distribution/collision/collision_shape.h"

namespace saddleback::distribution {

/// A shape laid into the plane of another: a point m of its own plane comes to at + turn * m. `turn` holds the scale.
struct Pose {
  Vec2 at;
  Eigen::Matrix2d turn;
  Vec2 operator()(const Vec2& m) const { return at + turn * m; }
};

/// Bounds by how much a point m of the moving shape's plane moves at most: base + per_length * |m|.
struct Motion {
  double base = 0, per_length = 0;
  double of(const Vec2& m) const { return base + per_length * m.norm(); }
};

/// A place where one shape is in the other, and how deep. Lengths are those of the plane that both are laid in.
struct Overlap {
  double depth = -SignedDistance::k_far;  ///< > 0: they have a common point however the shape moves
  Vec2 point = Vec2::Zero();              ///< of the moving shape's plane
  double radius = 0;                      ///< of the disk there
  bool is_of_other = false;               ///< whether the disk is one of the other shape
  Vec2 other_point = Vec2::Zero();        ///< where it lies, in the other shape's plane laid out
};

/// Returns false only if the boxes of the two have no common point, so that the shapes have none.
bool boxes_meet(const CollisionShape& body, const Pose& pose, const CollisionShape& other, double other_scale);

/// Holds what is looked for: places deeper than `least`; the search stops at the first that is deeper than `enough`,
/// and looks at no more than the `most_disks` largest disks of either.
struct Search {
  double least = -SignedDistance::k_far, enough = SignedDistance::k_far;
  std::size_t most_disks = 1000;
};

/// The deepest place known from the disks of either: a lower bound, found by the grids of distances. `scale` of the
/// moving shape, `other_scale` of the one that lies at the origin. O(disks).
Overlap find_overlap(const CollisionShape& body, double scale, const Pose& pose, const Motion& motion,
                     const CollisionShape& other, double other_scale, const Search& search);

/// Tells whether outlines cross when the shape is laid into the plane of the other, up to rounding. O(corners of both)
/// for most, O(their product) at worst.
bool outlines_cross(const Shape& shape, const Pose& pose, const Shape& other, double other_scale);

}  // namespace saddleback::distribution
