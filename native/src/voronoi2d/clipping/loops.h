#pragma once
// Parts of the plane as closed polygons: outlines counter-clockwise, holes clockwise.

#include <algorithm>
#include <span>
#include <vector>

#include "saddleback/types.h"

namespace saddleback::voronoi2d {

using Loop = std::vector<Vec2>;

inline void add_point(Loop& loop, const Vec2& point) {
  if (loop.empty() || loop.back() != point) loop.push_back(point);
}

// Area and center of mass of loops, counted from a point near them. What rounding does to slivers leaves an area of 0
// or more, and a center of mass among the points.
inline void add_moments(std::span<const Loop> loops, const Vec2& near, double& area, Vec2& centroid) {
  double twice_area = 0;
  Vec2 moment(0, 0), low = near, high = near;
  for (const Loop& loop : loops) {
    Vec2 before = loop.back() - near;
    for (const Vec2& point : loop) {
      const Vec2 corner = point - near;
      const double cross = before.x() * corner.y() - before.y() * corner.x();
      twice_area += cross;
      moment += cross * (before + corner);
      before = corner;
      low = low.cwiseMin(point), high = high.cwiseMax(point);
    }
  }
  area = std::max(0.0, 0.5 * twice_area);
  centroid = near + moment / (3 * twice_area);
  if (area > 0) centroid = centroid.cwiseMax(low).cwiseMin(high);
}

}  // namespace saddleback::voronoi2d
