#include "support/simd/simd_plain.h"

#define SADDLEBACK_WAVE_KERNEL k_wave_kernel_plain
#include "geodesics/graph/window_batches_kernel.h"
