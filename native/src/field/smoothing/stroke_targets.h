#pragma once
// The directions that strokes and the boundary demand of the faces that they run through.

#include <span>
#include <vector>

#include "saddleback/field/direction_field.h"

#include "field/connection/dual_loops.h"
#include "field/smoothing/face_springs.h"

namespace saddleback {

/// A face that a stroke runs through, in the stroke's order; each face once a stroke.
struct StrokeFace {
  Index face;
  double angle;      ///< of the stroke there, radians in the face's chart
  double stiffness;  ///< k_fixed for hard strokes
};
using StrokeFaces = std::vector<StrokeFace>;

/// One list a stroke and, when `along_boundary`, one a boundary loop after them.
/// \throw InputError for a stroke of another mesh, weights that are not positive and finite, hard strokes that
/// disagree.
std::vector<StrokeFaces> stroke_faces(const Mesh& mesh, int symmetry, std::span<const Stroke> strokes,
                                      bool along_boundary);

/// Springs that turn the field of those angles onto the strokes. Of the angles that are equal by symmetry those are
/// taken that bend the field least along each stroke and from each stroke to the nearest other ones.
FaceSprings<double> turning_springs(const Mesh& mesh, int symmetry, std::span<const double> angles,
                                    const std::vector<StrokeFaces>& strokes);

/// Springs for powers of directions.
FaceSprings<std::complex<double>> power_springs(const Mesh& mesh, int symmetry,
                                                const std::vector<StrokeFaces>& strokes);

}  // namespace saddleback
