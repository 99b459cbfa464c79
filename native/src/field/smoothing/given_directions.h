#pragma once
// Directions that are given for some of the faces or vertices, as springs.

#include <complex>
#include <span>
#include <vector>

#include "saddleback/field/direction_field.h"

#include "field/smoothing/face_springs.h"

namespace saddleback {

/// The part of a vector within a face, as a number in the face's chart.
std::complex<double> part_within(const Mesh& mesh, Index face, const Vec3& vector);
/// Tells whether a vector, rather than its rounding, has a part within the face.
bool has_part_within(std::complex<double> part, const Vec3& vector);

/// Returns for each face the power of the direction that is wanted there, its size the stiffness; 0 where nothing is
/// given. A face takes the mean of its corners' directions where vertices have them. \throw InputError for another
/// number of directions than faces or vertices, one that is not finite or, of a face, has no part within it; another
/// number of weights, one that is negative or not finite. O(F).
std::vector<std::complex<double>> powers_of_directions(const Mesh& mesh, int symmetry, const GivenDirections& given);

/// Returns by how much a field of those angles has to turn in each face to come near to the wanted powers and to what
/// its springs draw it by. Of directions that are equal by symmetry those are taken that go on what is next to them:
/// powers, which do not tell them apart, are relaxed, and their angles followed from face to face, large powers
/// first. 	hrow Cancelled. O(F log F), and one linear system.
std::vector<double> turns_towards(const Mesh& mesh, const SurfaceConnection& connection, int symmetry,
                                  std::span<const double> angles, const std::vector<std::complex<double>>& wanted,
                                  const FaceSprings<double>& springs,
                                  const MultigridSolver<std::complex<double>>::Accuracy& accuracy,
                                  const JobStage& stage);

}  // namespace saddleback
