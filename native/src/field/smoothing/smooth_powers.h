#pragma once
// The smoothest direction field.

#include <complex>
#include <vector>

#include "field/smoothing/face_springs.h"

namespace saddleback {

/// Finds, in each component, of all fields of unit mean square, one of the least energy: the connection Laplacian's
/// first eigenvector against the faces' areas [knoppel2013], by locally optimal preconditioned conjugate gradients
/// [knyazev2001], then evened out. As powers of directions, from `start`. About 10 steps and 3 linear systems. \throw
/// Cancelled.
std::vector<std::complex<double>> smoothest_powers(const Mesh& mesh, const PowerGraph& graph,
                                                   const std::vector<std::complex<double>>& start,
                                                   const JobStage& stage);

}  // namespace saddleback
