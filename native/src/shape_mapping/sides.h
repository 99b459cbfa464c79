#pragma once
// On which side of a line of the plane a point lies, never on it: all corners of outlines count as shifted by the same
// infinitesimal vector (-e, -e^2) against all vertices. So every decision about outlines and flat faces agrees with
// every other (simulation of simplicity [edelsbrunner1990]).

#include "predicates/predicates.h"

namespace saddleback {

/// Tells whether a vertex lies left of the line from corner a to corner b, a != b.
inline bool is_vertex_left(const Vec2& a, const Vec2& b, const Vec2& vertex) {
  using predicates::Sign;
  const Sign sign = predicates::orient_2d({a.x(), a.y()}, {b.x(), b.y()}, {vertex.x(), vertex.y()});
  if (sign != Sign::zero) return sign == Sign::positive;
  return a.y() != b.y() ? b.y() < a.y() : b.x() > a.x();
}

/// Tells whether a corner lies left of the line from vertex u to vertex v, u != v.
inline bool is_corner_left(const Vec2& u, const Vec2& v, const Vec2& corner) {
  using predicates::Sign;
  const Sign sign = predicates::orient_2d({u.x(), u.y()}, {v.x(), v.y()}, {corner.x(), corner.y()});
  if (sign != Sign::zero) return sign == Sign::positive;
  return u.y() != v.y() ? v.y() > u.y() : v.x() < u.x();
}

/// Tells whether a vertex lies above a corner.
inline bool is_vertex_above(const Vec2& corner, const Vec2& vertex) { return vertex.y() >= corner.y(); }

/// Tells whether the triangle of three vertices runs counter-clockwise.
inline bool is_upright(const Vec2& a, const Vec2& b, const Vec2& c) {
  return predicates::orient_2d({a.x(), a.y()}, {b.x(), b.y()}, {c.x(), c.y()}) == predicates::Sign::positive;
}

}  // namespace saddleback
