#include "support/simd_avx2.h"

#define SADDLEBACK_WAVE_KERNEL k_wave_kernel_avx2
#include "geodesics/window_waves_kernel.h"
