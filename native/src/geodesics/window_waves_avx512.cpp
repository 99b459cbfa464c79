#include "support/simd_avx512.h"

#define SADDLEBACK_WAVE_KERNEL k_wave_kernel_avx512
#include "geodesics/window_waves_kernel.h"
