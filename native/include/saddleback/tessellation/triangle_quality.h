#pragma once
// Measures of how near the triangles of a mesh are to equilateral ones, and its vertices to six neighbors.

#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/types.h"

namespace saddleback {

struct TriangleQuality {
  std::vector<double> quality;            ///< (T,) 6 S / (sqrt(3) p h): 1 equilateral, 0 without area
  std::vector<double> least_angle;        ///< (T,) radians
  std::vector<double> greatest_angle;     ///< (T,) radians
  std::vector<Index> valence;             ///< (V,) edges at each vertex
  std::vector<std::uint8_t> at_boundary;  ///< (V,) on an edge with one triangle
  double irregular = 0;                   ///< share of vertices in use whose valence is not 6, on the boundary not 4
};

/// S is a triangle's area, p half its perimeter, h its longest edge [frey1999]. Any triangles will do, manifold or not.
/// \throw InputError for an index out of range or a coordinate that is not finite, naming the first; Cancelled.
/// O(V + T log T).
TriangleQuality triangle_quality(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                                 Job* job = nullptr);

}  // namespace saddleback
