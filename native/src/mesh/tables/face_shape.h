#pragma once
// The measures of one triangle in space, and which triangles are too thin to be measured.

#include <array>
#include <span>

#include "saddleback/types.h"

namespace saddleback {

/// Coordinates beyond this are refused: products of four lengths (predicates, windows) must stay finite.
inline constexpr double k_largest_coordinate = 1e60;

/// A face without an edge longer than this counts as a point, for the same reason at the other end.
inline constexpr double k_smallest_edge = 1e-60;

/// A face lower than this share of its longest edge has no area: double coordinates (16 digits) then leave fewer than
/// four digits of its height, and its angles mean nothing.
inline constexpr double k_degenerate_height = 1e-12;

struct FaceShape {
  std::array<double, 3> length;  ///< of edge i to i+1
  std::array<double, 3> angle;   ///< at corner i, radians
  double area = 0;
};

/// Lengths, angles and area. The area comes from the cross product of the two shortest edges and each angle from
/// atan2(2 area, dot), which keeps full relative accuracy for needles, where the law of cosines loses half the digits
/// [kahan2014].
FaceShape measure_face(const Vec3& a, const Vec3& b, const Vec3& c);

/// Angles and area from the lengths alone, by a formula that loses no digits but those that needles' lengths lack
/// [kahan2014].
FaceShape measure_face(std::span<const double, 3> length);

/// Tells whether no triangle, or none with an area, has these lengths.
bool is_degenerate_face(std::span<const double, 3> length);

/// Tells whether a face has no area: collinear corners (decided exactly) or a height within k_degenerate_height.
bool is_degenerate_face(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace saddleback
