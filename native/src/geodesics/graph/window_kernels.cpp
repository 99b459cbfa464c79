// Chooses kernels by the instruction sets of this machine.

#include <array>

#include "saddleback/error.h"

#include "geodesics/graph/graph_arcs.h"

namespace saddleback {

#if defined(SADDLEBACK_X86)
extern const WaveKernel k_wave_kernel_avx512, k_wave_kernel_avx2;
#endif
extern const WaveKernel k_wave_kernel_plain;

namespace {

struct Offer {
  const WaveKernel* kernel;
  bool runs;
};

/// Fastest first.
auto offers() {
#if defined(SADDLEBACK_X86)
  __builtin_cpu_init();
  return std::array{
      Offer{&k_wave_kernel_avx512, __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")},
      Offer{&k_wave_kernel_avx2, __builtin_cpu_supports("avx2") != 0}, Offer{&k_wave_kernel_plain, true}};
#else
  return std::array{Offer{&k_wave_kernel_plain, true}};
#endif
}

}  // namespace

const WaveKernel& wave_kernel(const std::string& instructions) {
  std::string names;
  for (const Offer& offer : offers()) {
    if (offer.runs && (instructions == "auto" || instructions == offer.kernel->name)) return *offer.kernel;
    if (offer.runs) names += message(", '", offer.kernel->name, "'");
  }
  throw InputError(message("instructions: this machine runs 'auto'", names, ", not '", instructions, "'"));
}

}  // namespace saddleback
