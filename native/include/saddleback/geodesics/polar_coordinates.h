#pragma once
// Coordinates along a curve and across it.

#include <vector>

#include "saddleback/geodesics/saddle_vertex_graph.h"
#include "saddleback/mesh/surface_curve.h"

namespace saddleback {

/// Vertices about a curve, in order of their indices.
struct PolarCoordinates {
  std::vector<Index> vertices;
  std::vector<double> distance;  ///< signed: positive left of the curve
  std::vector<double> along;     ///< arc length of the nearest point of the curve
  std::vector<std::uint8_t> shadowed;
};

/// Distance and arc-length coordinate of every vertex within `radius` of a curve, by exact window propagation from it:
/// rays at right angles to the segments, fans at bends. Where the nearest point of the curve is not unique (the cut
/// locus) one of them is taken; behind a saddle vertex (`shadowed`) the coordinate is that of the way by it. Beyond the
/// ends of an open curve the foot is its end, and the side that of the curve run straight on.
/// \throw InputError for a curve of another mesh, a radius that is not above 0; Cancelled.
/// O(n sqrt(n) log n) for n vertices within the radius.
PolarCoordinates polar_coordinates(const SaddleVertexGraph& graph, const SurfaceCurve& curve, double radius,
                                   Job* job = nullptr);

}  // namespace saddleback
