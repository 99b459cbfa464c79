#include "distribution/collision/overlap.h"

#include <algorithm>

namespace saddleback::distribution {
namespace {

double side(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

double square(double x) { return x * x; }

bool crosses(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  return (side(c, d, a) > 0) != (side(c, d, b) > 0) && (side(a, b, c) > 0) != (side(a, b, d) > 0);
}

}  // namespace

bool boxes_meet(const CollisionShape& body, const Pose& pose, const CollisionShape& other, double other_scale) {
  // Along each of the four sides of the two boxes: the way between the centers against what the boxes reach.
  const Vec2 way = pose(body.box_center) - other_scale * other.box_center;
  const Vec2 half = other_scale * other.box_half;
  const Eigen::Matrix2d arms = pose.turn * body.box_half.asDiagonal();
  const Vec2 reach = arms.cwiseAbs().rowwise().sum() + half;
  if ((way.array().abs() > reach.array()).any()) return false;
  for (int i = 0; i < 2; ++i) {
    const Vec2 normal(-pose.turn(1, i), pose.turn(0, i));
    const double across = std::abs(normal.dot(arms.col(1 - i))) + normal.cwiseAbs().dot(half);
    if (std::abs(normal.dot(way)) > across) return false;
  }
  return true;
}

Overlap find_overlap(const CollisionShape& body, double scale, const Pose& pose, const Motion& motion,
                     const CollisionShape& other, double other_scale, const Search& search) {
  Overlap best;
  best.depth = search.least;
  const double reach = scale * body.shape.circumradius(), other_reach = other_scale * other.shape.circumradius();
  if (!(pose.at.squaredNorm() < square(reach + other_reach))) return best;
  if (!boxes_meet(body, pose, other, other_scale)) return best;
  // No place is deeper in a shape than its largest disk's middle.
  const double deepest = scale * body.disks[0].radius, other_deepest = other_scale * other.disks[0].radius;
  const double per_other_unit = 1 / other_scale;
  for (std::size_t i = 0; i < std::min(body.disks.size(), search.most_disks); ++i) {
    const Disk& disk = body.disks[i];
    if (scale * disk.radius + other_deepest - motion.base <= best.depth) break;
    const Vec2 place = pose(disk.center);
    const double bound = scale * disk.radius - motion.of(disk.center);
    if (bound + other_deepest <= best.depth || !(place.squaredNorm() < square(bound + other_reach - best.depth)))
      continue;
    const double depth = bound - other_scale * other.distance.upper(place * per_other_unit);
    if (depth <= best.depth) continue;
    best = {depth, disk.center, disk.radius * scale, false, place};
    if (depth > search.enough) return best;
  }
  const Eigen::Matrix2d back = pose.turn.inverse();
  for (std::size_t i = 0; i < std::min(other.disks.size(), search.most_disks); ++i) {
    const Disk& disk = other.disks[i];
    if (other_scale * disk.radius + deepest - motion.base <= best.depth) break;
    const Vec2 place = other_scale * disk.center, own = back * (place - pose.at);
    const double bound = other_scale * disk.radius - motion.of(own);
    if (bound + deepest <= best.depth || !(scale * scale * own.squaredNorm() < square(bound + reach - best.depth)))
      continue;
    const double depth = bound - scale * body.distance.upper(own);
    if (depth <= best.depth) continue;
    best = {depth, own, disk.radius * other_scale, true, place};
    if (depth > search.enough) return best;
  }
  return best;
}

bool outlines_cross(const Shape& shape, const Pose& pose, const Shape& other, double other_scale) {
  const double reach = other_scale * other.circumradius();
  for (const Shape::Loop& loop : shape.loops()) {
    Vec2 a = pose(loop.back());
    for (const Vec2& corner : loop) {
      const Vec2 b = pose(corner), low = a.cwiseMin(b), high = a.cwiseMax(b);
      const bool is_near = (low.array() < reach).all() && (high.array() > -reach).all();
      for (const Shape::Loop& others : is_near ? other.loops() : std::span<const Shape::Loop>()) {
        Vec2 c = other_scale * others.back();
        for (const Vec2& other_corner : others) {
          const Vec2 d = other_scale * other_corner;
          const bool is_apart = (c.array() < low.array() && d.array() < low.array()).any() ||
                                (c.array() > high.array() && d.array() > high.array()).any();
          if (!is_apart && crosses(a, b, c, d)) return true;
          c = d;
        }
      }
      a = b;
    }
  }
  return false;
}

}  // namespace saddleback::distribution
