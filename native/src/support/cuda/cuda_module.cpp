#include "support/cuda/cuda_module.h"

#include <atomic>

#include "saddleback/error.h"

namespace saddleback {
namespace {

std::atomic<const CudaModule*> current{nullptr};
std::atomic<std::uint64_t> most_bytes{0};

}  // namespace

void set_cuda_module(const CudaModule* module) {
  if (module && module->version != CudaModule::k_version) {
    throw DeviceError(message("device: the CUDA module is of another version of Saddleback (its table is version ",
                              module->version, ", this one needs ", CudaModule::k_version, "); install both together"));
  }
  current.store(module);
}

const CudaModule* cuda_module() { return current.load(); }

void limit_cuda_memory(std::uint64_t bytes) { most_bytes.store(bytes); }
std::uint64_t cuda_memory_limit() { return most_bytes.load(); }

}  // namespace saddleback
