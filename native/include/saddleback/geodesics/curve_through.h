#pragma once
// Curves drawn by a few points: geodesics from one to the next, splines, Bezier curves.

#include "saddleback/geodesics/saddle_vertex_graph.h"
#include "saddleback/mesh/surface_curve.h"

namespace saddleback {

/// Halvings of a piece of a smooth curve: 2^5 pieces are smooth to the eye.
inline constexpr int k_default_halvings = 5;

struct CurveThroughOptions {
  bool closed = false;
  /// Says whether the curve passes the points without corners: a cubic Bezier curve from each to the next, along the
  /// bisector of the directions there, in place of the shortest way.
  bool smooth = false;
  int halvings = k_default_halvings;
};

/// The curve through points, which may be far apart. \throw InputError for fewer than two points (three, if closed), a
/// point off the mesh, one that is not joined with the one before or the same (naming it), halvings outside 0 to 10;
/// Cancelled. A distance field a point, then O(faces crossed) each time that a piece is halved.
SurfaceCurve curve_through(const SaddleVertexGraph& graph, const SurfacePoints& points,
                           const CurveThroughOptions& options = {}, Job* job = nullptr);

/// The Bezier curve of control points, by de Casteljau's construction with shortest ways in place of straight lines,
/// which stay in their homotopy class [morera2007], by halves as in [mancinelli2022]. \throw InputError as above.
SurfaceCurve bezier_curve(const SaddleVertexGraph& graph, const SurfacePoints& controls,
                          int halvings = k_default_halvings, Job* job = nullptr);

}  // namespace saddleback
