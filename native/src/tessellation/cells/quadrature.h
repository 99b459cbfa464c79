#pragma once
// Integrals over triangles.

#include <array>

#include "saddleback/types.h"

namespace saddleback {

struct QuadraturePoint {
  double a, b, weight;  ///< barycentric coordinates a, b, 1 - a - b
};
/// Three points, exact to degree 2: all that a uniform density needs.
inline constexpr std::array<QuadraturePoint, 3> k_quadratic{{{0.5, 0.5, 1. / 3}, {0.5, 0, 1. / 3}, {0, 0.5, 1. / 3}}};
/// Six points, exact to degree 4 [dunavant1985].
inline constexpr double k_a = 0.445948490915965, k_b = 0.091576213509771;
inline constexpr double k_weight_a = 0.223381589678011, k_weight_b = 0.109951743655322;
inline constexpr std::array<QuadraturePoint, 6> k_quartic{{{k_a, k_a, k_weight_a},
                                                           {k_a, 1 - 2 * k_a, k_weight_a},
                                                           {1 - 2 * k_a, k_a, k_weight_a},
                                                           {k_b, k_b, k_weight_b},
                                                           {k_b, 1 - 2 * k_b, k_weight_b},
                                                           {1 - 2 * k_b, k_b, k_weight_b}}};

inline Vec3 at(const QuadraturePoint& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  return q.a * a + q.b * b + (1 - q.a - q.b) * c;
}

}  // namespace saddleback
