#if !defined(__clang__)
// g++ 12 takes the undefined registers in its own headers for mistakes (its bug 105593).
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include "support/simd/simd_avx512.h"

#define SADDLEBACK_WAVE_KERNEL k_wave_kernel_avx512
#include "geodesics/graph/window_batches_kernel.h"
