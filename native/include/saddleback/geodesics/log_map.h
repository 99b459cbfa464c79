#pragma once
// The logarithmic map about a point and its inverse, the exponential map.

#include <span>
#include <vector>

#include "saddleback/geodesics/saddle_vertex_graph.h"

namespace saddleback {

/// Vertices about a point, in order of their indices.
struct LogMap {
  std::vector<Index> vertices;
  std::vector<double> distance;
  std::vector<double> angle;  ///< as `trace` takes it: trace(center, angle, distance) ends at the vertex
  std::vector<Vec2> uv;       ///< distance times the unit vector of the scaled angle
  std::vector<std::uint8_t>
      shadowed;  ///< the shortest way bends at a saddle vertex, the angle is that of the way there
};

/// The logarithmic map: length and direction of departure of the shortest path to every vertex within `radius`, exact.
/// At an interior vertex angles are scaled so that its total angle becomes 2 pi; a center within 1e-10 (barycentric) of
/// a vertex is that vertex. Angles of an open fan (on the boundary) are as they are. \throw InputError for a point off
/// the mesh, a radius that is not above 0; Cancelled. O(n sqrt(n) log n) for n vertices within the radius.
LogMap log_map(const SaddleVertexGraph& graph, const SurfacePoint& center, double radius, Job* job = nullptr);

/// The exponential map: where straightest geodesics from `center` end, each of the length and direction of a (scaled,
/// as above) vector; those that the boundary stops (see `trace`) end there. \throw InputError for a point off the mesh,
/// a vector that is not finite (naming its index), one too long to follow; Cancelled. O(faces crossed).
SurfacePoints exp_map(const Mesh& mesh, const SurfacePoint& center, std::span<const Vec2> uv, int threads = 0,
                      Job* job = nullptr);

/// Surface angle for a unit of scaled angle at a point: total_angle / 2 pi at an interior vertex, else 1.
double angle_scale(const Mesh& mesh, const SurfacePoint& point);

}  // namespace saddleback
