#pragma once
// The lines of a mesh that a remesh should keep: creases, the boundary, edges that somebody chose.

#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "saddleback/mesh/surface_curve.h"

namespace saddleback {

struct FeatureCurveOptions {
  double angle =
      40 * std::numbers::pi / 180;  ///< radians: an edge whose faces' normals differ more is a feature; pi: none
  bool boundary = true;             ///< whether the edges of the boundary are features
  std::span<const std::array<Index, 2>> edges;  ///< more of them, each by its two vertices
  /// Radians: where a line turns by more than this it ends, and another begins.
  double corner_angle = 50 * std::numbers::pi / 180;
  /// Edges that are features by their angle alone are none where all the lines that they hang together with are shorter
  /// than this: noise of scans, or details that a coarse remesh cannot show.
  double least_length = 0;
};

/// The feature edges as curves: as long as can be between the vertices where their number is not two or where they
/// turn sharply; lines without such a vertex are closed. In the order of their first vertices, each edge once.
///
/// \throw InputError for an angle outside [0, pi], a length below 0, two vertices that no edge joins. O(V + F).
std::vector<SurfaceCurve> feature_curves(const Mesh& mesh, const FeatureCurveOptions& options);

}  // namespace saddleback
