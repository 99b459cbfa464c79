#pragma once
// Decisions in the plane as a CUDA device makes them; for tests, since diagrams come to few of the hard ones.

#include <cstddef>
#include <cstdint>

#include "support/cuda/cuda_module.h"

namespace saddleback {

/// Decides about four points; 2: unknown.
struct PlaneSigns {
  std::int8_t orient_2d, compare_distances;                  ///< as the predicates say
  std::int8_t turn_sign, known_circle_sign, distance_order;  ///< as diagrams ask for them
  static constexpr int k_count = 5;
};

/// Decides on each four points: 8 numbers, the corners of a triangle and another one. Never throws; `reason` says why
/// it failed.
CudaStatus plane_signs_on_device(int device, const double* points, std::size_t fours, PlaneSigns* signs,
                                 CudaReason& reason);

}  // namespace saddleback
