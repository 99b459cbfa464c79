#pragma once
// Every combinatorial decision on floating-point numbers: those in the plane, and what follows from them in space.

#include "saddleback/types.h"

#include "predicates/plane_predicates.h"

namespace saddleback::predicates {

/// Tells exactly whether three points in space lie on one line: then, and only then, their shadows along all three axes
/// do. O(1).
inline bool collinear_3d(const Vec3& a, const Vec3& b, const Vec3& c) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    if (orient_2d({a[i], a[j]}, {b[i], b[j]}, {c[i], c[j]}) != Sign::zero) return false;
  }
  return true;
}

}  // namespace saddleback::predicates
