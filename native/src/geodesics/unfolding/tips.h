#pragma once
// Tips: inner vertices of a small total angle, round which needles would send rays for ever.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "saddleback/mesh/mesh.h"

namespace saddleback {

/// Returns the tangent of the total angle of a tip, which is less than a right one; infinity for every other vertex.
inline double tangent_of_tip(const Mesh& mesh, Index vertex) {
  const bool is_tip = !mesh.is_boundary(vertex) && mesh.total_angle(vertex) < std::numbers::pi / 2;
  return is_tip ? std::tan(mesh.total_angle(vertex)) : std::numeric_limits<double>::infinity();
}

/// Tells whether rays that end at a tip have gone all round it, where the tip lies so far ahead and aside of their root
/// along an edge to it: they cross its edges twice, which no shortest path does. Else they would do so pi / angle
/// times.
inline bool circles(double tangent, double ahead, double aside) {
  constexpr double k_turn = 1 + 1e-6;
  return aside > k_turn * tangent * std::max(ahead, 0.0);
}

}  // namespace saddleback
