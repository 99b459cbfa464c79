#pragma once
// The exact distance from a curve to the vertices about it.

#include <span>
#include <vector>

#include "saddleback/mesh/surface_curve.h"

#include "geodesics/wavefront/directions_at_point.h"
#include "geodesics/wavefront/wavefront_distances.h"

namespace saddleback {

/// A vertex and the nearest point of the curve.
struct CurveFoot {
  Index vertex;
  double distance;   ///< >= 0
  double along;      ///< arc length of the foot, 0 to the curve's length
  std::int8_t side;  ///< 1 left of the curve, -1 right, 0 on it; beyond an open end, of the curve run straight on
  bool shadowed;     ///< the shortest way bends at a saddle vertex
};

/// A side of a curve, as a part of the border of an area, which is on the left where one goes along the border. Parts
/// meet where one ends at the point, named by a number, at which another starts; closed curves have no such points.
struct BorderPart {
  const SurfaceCurve* curve;
  std::int8_t side;  ///< of the area: 1 left of the curve, -1 right, where the border runs against the curve
  Index start = k_none, end = k_none;
};

/// The segment's end as a point, exactly at a vertex or on an edge where it is but for rounding.
SurfacePoint end_point(const CurveSegment& segment, bool at_begin);

/// The direction in which the segment leaves one of its ends.
double direction_of(const Mesh& mesh, const DirectionsAtPoint& star, const CurveSegment& segment, bool at_begin);

/// Sends rays from a curve: at right angles to both sides of every segment, fans where it bends and at its ends. Holds
/// scratch memory of O(V + F); one a thread.
class CurveWindows {
 public:
  explicit CurveWindows(const Unfolding& unfolding)
      : unfolding_(unfolding), mesh_(unfolding.mesh()), field_(unfolding) {}

  /// The vertices within limits.radius, in any order. Exact: each has its shortest distance, unless limits.edges says
  /// otherwise. The stage is advanced until the first windows run, then `report` is asked. \throw Cancelled.
  void from_curve(const SurfaceCurve& curve, const RayLimits& limits, std::vector<CurveFoot>& feet,
                  const JobStage& stage = {}, const WatchedPlaces* places = nullptr, const ReportRays& report = {});
  /// Does the same from the border of an area into it: rays set out on that side alone, and end at the border. Without
  /// what the feet tell: the field has the distances.
  void from_border(std::span<const BorderPart> border, const RayLimits& limits, const WatchedPlaces* places,
                   const JobStage& stage = {});
  const WavefrontDistances& field() const { return field_; }
  /// Distances of the last call's places: of those that see the curve, or a saddle vertex with one that does, within
  /// the limits; else infinity or the length of a longer way.
  std::span<const double> place_distances() const { return field_.places().values(); }

 private:
  void reach_places(const CurveSegment& segment);
  void emit_from_segment(const CurveSegment& segment, int side);
  void add_sources(const SurfaceCurve& curve);
  void emit_from_bend(const CurveSegment& in, const CurveSegment& out, double along, int only);
  void emit_from_corners(const BorderPart& part, std::span<const BorderPart> border);
  void emit_from_end(const CurveSegment& segment, bool is_start, double along);

  const Unfolding& unfolding_;
  const Mesh& mesh_;
  WavefrontDistances field_;
};

}  // namespace saddleback
