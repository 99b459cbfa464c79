#pragma once
// Curves that follow a direction field.

#include <cstdint>
#include <limits>
#include <optional>

#include "saddleback/field/direction_field.h"
#include "saddleback/job.h"
#include "saddleback/mesh/trace.h"

namespace saddleback {

/// The reason for which a curve ends.
enum class StreamlineEnd : std::uint8_t {
  length,       ///< it is as long as wanted
  boundary,     ///< the surface ends
  singularity,  ///< it has come to a singular vertex, which is its last point
};

struct StreamlineOptions {
  double length = 0;  ///< mesh units, > 0
  /// Half of the length on either side of the start, so that the start is the middle unless one side stops early.
  bool both = false;
  /// Chooses, of the field's directions at the start, the one nearest to this; none: the first one.
  std::optional<Vec3> heading;
  /// The most by which the curve bends (geodesic curvature, radians per length). Where the field turns faster the curve
  /// lags behind, so that what is laid across it up to 1 / max_curvature on either side does not fold.
  double max_curvature = std::numeric_limits<double>::infinity();
  Job* job = nullptr;
};

struct Streamline {
  GeodesicPath path;
  std::size_t start = 0;  ///< which of the path's points is the start
  StreamlineEnd begin_reason = StreamlineEnd::length, end_reason = StreamlineEnd::length;
};

/// Integrates the field, continuous as DirectionField::angle_at gives it, by fourth-order steps of at most a quarter of
/// a face, shorter where the field turns far within one, cut at edges. A start at a singular vertex, or at the boundary
/// where the field leaves the surface, gives that point alone. Without `both` the curve begins at the start. \throw
/// InputError for a point off the mesh, a length or curvature that is not positive (a length not finite), a heading
/// that is not finite or across the surface, a curve over more than a million faces or eight million steps; Cancelled.
/// O(steps).
Streamline streamline(const DirectionField& field, const SurfacePoint& start, const StreamlineOptions& options);

}  // namespace saddleback
