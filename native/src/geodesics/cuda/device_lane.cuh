#pragma once
// window_waves_step.h for CUDA: a lane is a thread. What includes this is compiled without fused operations.

#include <cstdint>

#include "support/cuda/warp.cuh"

#define SADDLEBACK_STEP __device__ __forceinline__

namespace saddleback {
namespace {

/// Edges longer than this or shorter than its inverse, in mean edges, might ask for roots and quotients of other
/// numbers than those that Simd has them for.
constexpr double k_longest = 0x1p30;

struct Simd {
  using Floats = float;
  using Doubles = double;
  using Ints = std::int32_t;
  using Mask = bool;
  SADDLEBACK_STEP static float fill(float value) { return value; }
  SADDLEBACK_STEP static float pick(bool mask, float yes, float no) { return mask ? yes : no; }
  /// Picks without a branch.
  SADDLEBACK_STEP static bool pick(bool mask, bool yes, bool no) { return (mask & yes) | (!mask & no); }
  SADDLEBACK_STEP static bool any(bool mask) { return __any_sync(k_warp, mask); }
  SADDLEBACK_STEP static float min(float a, float b) { return a < b ? a : b; }
  SADDLEBACK_STEP static float max(float a, float b) { return a > b ? a : b; }
  // Quotients and roots as IEEE's, by the steps that compilers take for numbers that are neither huge nor tiny, but
  // without asking each time whether they are: asking takes as long, and lanes wait for one another. After
  // [markstein1990]. See k_longest. Compilers correct a quotient twice; from the reciprocals of compute capability 9.0
  // once does, by trial of all pairs of significands.
  SADDLEBACK_STEP static float quotient(float a, float b) {
    float inverse;
    asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(inverse) : "f"(b));
    inverse = __fmaf_rn(inverse, __fmaf_rn(-b, inverse, 1), inverse);
    float result = __fmul_rn(a, inverse);
#if __CUDA_ARCH__ != 900
    result = __fmaf_rn(__fmaf_rn(-b, result, a), inverse, result);
#endif
    return __fmaf_rn(__fmaf_rn(-b, result, a), inverse, result);
  }
  /// a / (a + b) for b > 0.
  SADDLEBACK_STEP static float share(float a, float b) { return quotient(a, a + b); }
  SADDLEBACK_STEP static float sqrt(float a) {
    float inverse;
    asm("rsqrt.approx.ftz.f32 %0, %1;" : "=f"(inverse) : "f"(fmaxf(a, 0x1p-100f)));  // of nothing it is infinite
    const float root = __fmul_rn(a, inverse);
    return __fmaf_rn(__fmaf_rn(-root, root, a), 0.5f * inverse, root);
  }
};

}  // namespace
}  // namespace saddleback

#include "geodesics/graph/window_batches_step.h"
