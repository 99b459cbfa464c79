#include <cuda_runtime.h>

#include "support/cuda/host_pinning.h"

namespace saddleback {

bool pin_host_memory(void* memory, std::uint64_t bytes) {
  if (cudaHostRegister(memory, bytes, cudaHostRegisterPortable) == cudaSuccess) return true;
  (void)cudaGetLastError();  // the caller has another way: the next check must not see it
  return false;
}

void unpin_host_memory(void* memory) {
  if (cudaHostUnregister(memory) != cudaSuccess) (void)cudaGetLastError();  // the device is lost, and the pin with it
}

}  // namespace saddleback
