#pragma once
// The smoothest direction field.

#include <complex>
#include <vector>

#include "face_springs.h"

namespace saddleback {

/// In each component, of all fields of unit mean square, one of the least energy: the connection Laplacian's first
/// eigenvector against the faces' areas (Knoeppel, Crane, Pinkall and Schroeder 2013), by locally optimal preconditioned
/// conjugate gradients (Knyazev 2001). As powers of directions, from `start`. About 20 steps. \throw Cancelled.
std::vector<std::complex<double>> smoothest_powers(const Mesh& mesh,
                                                   const std::vector<GraphEdge<std::complex<double>>>& graph,
                                                   std::vector<std::complex<double>> start, const JobStage& stage);

}  // namespace saddleback
