#include "support/simd_plain.h"

#define SADDLEBACK_WAVE_KERNEL k_wave_kernel_plain
#include "geodesics/window_waves_kernel.h"
