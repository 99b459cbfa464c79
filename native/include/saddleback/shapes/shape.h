#pragma once
// A shape to lay on a surface: a flat outline of one or several parts, with or without holes.

#include <cstdint>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/types.h"

namespace saddleback {

/// A region of the plane about the origin, which is what lies at the center of a placement; its x axis is what points
/// along the field. Immutable.
class Shape {
 public:
  using Loop = std::vector<Vec2>;  ///< corners, the last joined to the first
  using Part = std::vector<Loop>;  ///< an outline, then its holes

  /// Loops may run either way and repeat their first corner at the end. Parts may lie in each other's holes, but do not
  /// touch.
  /// \throw InputError naming part, loop and corner: no part, fewer than three corners, a coordinate that is not finite
  /// or beyond 1e30, loops that touch or cross themselves or each other, no area, a hole outside of its outline, a part
  /// within another. O(m log m) expected for m corners.
  explicit Shape(std::vector<Part> parts);
  /// One part without holes.
  explicit Shape(Loop outline);

  /// All loops, part by part: outlines counter-clockwise, holes clockwise, so that the shape is on the left.
  std::span<const Loop> loops() const { return loops_; }
  /// Returns the index of each part's outline among the loops, and at the end the number of loops.
  std::span<const Index> part_begins() const { return part_begins_; }
  Index part_count() const { return static_cast<Index>(part_begins_.size()) - 1; }
  Index corner_count() const;

  /// Distance of the farthest corner from the origin.
  double circumradius() const { return circumradius_; }
  /// Radius of the largest disk about the origin that lies within; 0 when the origin does not.
  double inradius() const { return inradius_; }
  double area() const { return area_; }
  /// Tells whether half a turn about the origin changes nothing (corners within 1e-9 of the circumradius).
  bool has_half_turn() const { return has_half_turn_; }
  /// Tells exactly whether a point lies inside; a point of the outline itself may count as either. O(m).
  bool contains(const Vec2& point) const;

  /// The shape with y negated.
  Shape mirrored() const;
  /// Returns the shape scaled, then turned counter-clockwise, then shifted. \throw InputError for a scale that is not
  /// positive, or what leaves the range of coordinates.
  Shape moved(double scale, double angle, const Vec2& shift) const;
  /// Tells exactly whether the two have a common point, outlines included. O(m n) for m and n corners.
  bool overlaps(const Shape& other) const;
  /// Returns the shape with the smallest circle around it moved to the origin and scaled to `radius`.
  Shape centered(double radius = 1) const;

 private:
  template <class Move>
  Shape with_corners(Move move) const;
  void check() const;
  void measure();

  std::vector<Loop> loops_;
  std::vector<Index> part_begins_;
  double circumradius_ = 0, inradius_ = 0, area_ = 0;
  bool has_half_turn_ = false;
};

}  // namespace saddleback

/// Shapes of circumradius 1 about their center. \throw InputError for what makes no shape.
namespace saddleback::shapes {

/// A regular polygon, its first corner on the x axis. corners >= 3.
Shape disk(Index corners = 64);
/// points >= 2 tips on the circle, the corners between them at the radius `inner` in (0, 1), one tip on the x axis.
/// 0.381966 makes five points a pentagram.
Shape star(Index points = 5, double inner = 0.381966011250105);
/// A rhombus along the x axis, `aspect` (>= 1) times as long as wide.
Shape needle(double aspect = 10);
/// Two circular arcs that meet in tips on the x axis, `aspect` (> 1) times as long as wide; corners (>= 4) in all.
Shape leaf(double aspect = 2.5, Index corners = 40);
/// A disk of the radius `round` in (0, 1) drawn out to a tip on the x axis; its other end touches the circle.
Shape drop(double round = 0.6, Index corners = 40);
/// A disk less a disk of the radius `inner` in (0, 1] that is moved by `shift` along the x axis; open towards x.
Shape crescent(double inner = 0.8, double shift = 0.4, Index corners = 48);

}  // namespace saddleback::shapes

namespace saddleback {

/// An image of a mask: rows from top to bottom, values 0 (outside) to 1 (inside).
struct MaskImage {
  std::span<const double> values;
  Index rows = 0, columns = 0;
};

/// The parts of an image where it is over one half, outlines by marching squares, simplified outwards only (the shape
/// covers all of what the outlines enclose). The image's right is x, up is y; centered, of circumradius 1, or else in
/// pixels with the first pixel's center at the origin.
/// \throw InputError: fewer values than rows times columns, a value that is not finite, max_corners < 8; no clear mask:
/// nothing or everything over one half, or more parts and holes than there are corners for. About O(pixels + m^2) for
/// outlines of m corners [lorensen1987]. Cancelled.
Shape shape_from_mask(const MaskImage& image, Index max_corners = 128, bool centered = true, Job* job = nullptr);

}  // namespace saddleback
