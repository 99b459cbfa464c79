#pragma once
// Curves tightened on the surface.

#include "saddleback/mesh/surface_curve.h"
#include "saddleback/mesh/trace.h"

namespace saddleback {

/// The locally shortest curve that a curve becomes when it is pulled tight on the surface: it stays in its homotopy
/// class. The ends of an open curve stay where they are. A closed one becomes a closed geodesic, whose points are
/// listed once, or contracts to a point: one point, of length 0. The result is straight but at vertices, which it
/// passes with at least pi on either side (but at the boundary). \throw Cancelled. O(faces crossed) a step, as
/// [sharp2020], on the faces themselves.
GeodesicPath shortened_curve(const SurfaceCurve& curve, Job* job = nullptr);

}  // namespace saddleback
