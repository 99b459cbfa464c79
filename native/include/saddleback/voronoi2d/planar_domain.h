#pragma once
// Parts of the plane within polygons.

#include <span>
#include <vector>

#include "saddleback/types.h"

namespace saddleback {

/// A simple polygon with holes.
class PlanarDomain {
 public:
  /// The outline first, then the holes, each in either direction, its last corner joined to its first. Corners may be
  /// repeated in a row, and loops may touch other loops in points. \throw InputError naming loop and corner: fewer than
  /// three corners, a coordinate that is not finite or beyond 1e60, loops that touch or cross themselves, cross each
  /// other or have a part of a side in common, a hole outside; it begins with `argument`. O(m log m + loops (m_0 +
  /// loops)) expected, m_0 of the m corners in the outline.
  explicit PlanarDomain(std::vector<std::vector<Vec2>> loops, const char* argument = "domain");

  /// Outline counter-clockwise, holes clockwise.
  std::span<const std::vector<Vec2>> loops() const { return loops_; }
  /// The least box about each loop.
  struct Box {
    Vec2 low, high;
    bool meets(const Box& other) const {
      return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
    }
  };
  std::span<const Box> boxes() const { return boxes_; }
  double area() const;
  /// O(loops + corners of those whose box holds the point).
  bool contains(const Vec2& point) const;

 private:
  std::vector<std::vector<Vec2>> loops_;
  std::vector<Box> boxes_;
};

}  // namespace saddleback
