#pragma once
// The copies that bend along a field, centered in a cell.

#include <array>
#include <optional>
#include <span>

#include "distribution/placed_shapes.h"
#include "distribution/placing_rules.h"

namespace saddleback::distribution {

/// Finds where points of a bent copy lie, and how far they move while its center moves within a cell. Curves of a field
/// do not cross: those through the cell run between those through its corners. So the copies at the corners tell.
class BentCell {
 public:
  /// `copy`: the smallest of the kind at the cell's center. All must outlive this.
  BentCell(const PlacingRules& rules, const PlacedShapes& settled, const Cell& cell, Index kind, const Copy& copy);

  /// Tells whether all copies meet one that lies there. Sets `meets` where the one at the center does. `radius`: the
  /// cell's.
  bool is_covered(double radius, bool& meets);
  /// Tells whether all copies reach beyond the border, or within what is `forbidden`: of each of its vertices `depth`
  /// says how far. Sets `meets` where the one at the center does.
  bool is_beyond_border(std::span<const std::uint8_t> forbidden, const std::vector<double>& depth, bool& meets);
  /// Returns by how much points of the copies move at most; infinite where that cannot be told.
  double motion();

 private:
  /// A copy, and the curve that it is laid along once that has been asked for.
  struct Laid {
    Copy copy;
    bool is_known = false;
    std::optional<CenterLine> line = {};
  };
  /// Where a point of a copy lies: as far along the curve, then at a right angle from it.
  struct Place {
    SurfacePoint point;
    double x_angle = 0;  ///< of the copy's x axis in the point's face
    double beyond = 0;   ///< how far it would be beyond the border
  };
  std::optional<Place> place_of(Laid& laid, const Vec2& of_copy) const;
  std::array<Laid, 3>& corners();
  template <class Measure>
  double motion(const Vec2& of_copy, Measure&& measure);
  bool is_covered_by(const Copy& there, Index other, const Disk& disk, const Place& place, const Vec2& in_other,
                     const Vec2& x_axis, double radius, bool& meets);
  static double apart(const Mesh& mesh, const Place& a, const Place& b);

  const PlacingRules& rules_;
  const PlacedShapes& settled_;
  const Cell& cell_;
  Index kind_;
  Laid center_;
  bool has_corners_ = false;
  std::array<Laid, 3> corners_;
};

}  // namespace saddleback::distribution
