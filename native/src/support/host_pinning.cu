#include <cuda_runtime.h>

#include "support/host_pinning.h"

namespace saddleback {

void* pin_host_memory(std::uint64_t bytes) {
  void* memory = nullptr;
  if (cudaHostAlloc(&memory, bytes, cudaHostAllocPortable) == cudaSuccess) return memory;
  (void)cudaGetLastError();  // the caller has another way: whoever asks next must not see it
  return nullptr;
}

void unpin_host_memory(void* memory) {
  if (cudaFreeHost(memory) != cudaSuccess) (void)cudaGetLastError();  // at the latest the process's end frees it
}

}  // namespace saddleback
