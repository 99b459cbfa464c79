#pragma once
// What is seen across an edge whose ends are placed, and straight lines that lead there.

#include <cmath>
#include <optional>

#include "geodesics/unfolding/face_strip.h"
#include "support/planar.h"
#include "tessellation/log_map/vertex_rings.h"

namespace saddleback {

// Of arcs, see ArcCodec. Ways that differ by less are equally long: which of them is shorter changes with the mesh's
// scale and place, so that it is their order or kind that decides.
inline constexpr double k_arc_rounding = 2e-9;

// An edge's end that a ray passes by less than this share of the edge's length is hit, but for rounding.
inline constexpr double k_hit = 1e-9;

/// Place of a vertex, seen from its anchor: the site or the last vertex at which the way from there bends for good.
struct VertexPlace {
  Vec2 at = Vec2::Zero();  ///< from the anchor, in its plane
  double distance = 0;     ///< from the site, never less than it is
  Index anchor = k_none;   ///< node from which it is seen straight on; k_none: the site
  Index found_by = 0;      ///< a wedge across whose edge it was placed, or one of the below
  static constexpr Index k_unplaced = -1, k_straight = -2, k_after_another = -3, k_center = -4, k_end_of_way = -5;
  /// Gives the place as it is seen from the site itself.
  static VertexPlace straight(const Vec2& place) { return {place, place.norm(), k_none, k_straight}; }
};

/// The anchor of an edge's ends, both placed from it, seen across the edge from the third corner.
struct EdgeSight {
  Vec2 anchor, ray;      ///< in the frame of the half-edge; from the anchor to the corner
  double distance = 0;   ///< the ray's length
  double beyond = 0;     ///< by how much of the edge's length the ray passes the edge's ends; below 0 past its start
  bool is_flat = false;  ///< nothing bends the surface between the anchor and the edge, nor the ray
};

/// Lays the anchor, the edge and the corner of a wedge in one plane. False where the anchor is on the corner's own side
/// of the edge, where the lengths make no triangle, or where the ray passes an end that is not nearly flat.
bool see(const VertexRings::Wedge& wedge, const VertexPlace& from, const VertexPlace& to, EdgeSight& sight);

/// Tells whether an edge of this length fits between two places in a plane: where anything bends the surface between,
/// sides fit by an accident alone.
bool fits(const Vec2& from, const Vec2& to, double length);

/// Tells whether a place at this distance from its anchor is seen straight: a way that bends to it is longer.
bool is_straight(const Vec2& at, double distance);

/// Measures the straight line that leads from `corner`, opposite a half-edge, across it to `end`, which is expected at
/// `goal`; all in the frame of the half-edge. None where something else is there, or nothing. O(faces crossed).
std::optional<double> line_across(const Unfolding& unfolding, Index halfedge, const Vec2& corner, const Vec2& goal,
                                  const LegEnd& end);

inline Vec2 polar(double length, double angle) { return {length * std::cos(angle), length * std::sin(angle)}; }

inline double angle_between(const Vec2& a, const Vec2& b) { return std::atan2(cross(a, b), a.dot(b)); }

}  // namespace saddleback
