#include <cuda_runtime.h>

#include "support/cuda/cuda_devices.h"

namespace saddleback {
namespace {

// The oldest architecture that the kernels are compiled for (native/cmake/cuda.cmake); newer ones run from PTX.
constexpr int k_oldest_capability = SADDLEBACK_CUDA_OLDEST;

int attribute(cudaDeviceAttr which, int device) {
  int value = 0;
  return cudaDeviceGetAttribute(&value, which, device) == cudaSuccess ? value : -1;
}

// Why the device cannot be used; empty when it can.
std::string objection(const CudaDevice& device) {
  if (device.compute_major * 10 + device.compute_minor < k_oldest_capability)
    return device.name + " has compute capability " + std::to_string(device.compute_major) + "." +
           std::to_string(device.compute_minor) + ", older than the " + std::to_string(k_oldest_capability / 10) + "." +
           std::to_string(k_oldest_capability % 10) + " that is needed";
  if (attribute(cudaDevAttrComputeMode, device.index) == cudaComputeModeProhibited)
    return device.name + " is in a compute mode that prohibits its use";
  return {};
}

}  // namespace

CudaDevices cuda_devices() {
  CudaDevices result;
  int count = 0;
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status != cudaSuccess) {
    (void)cudaGetLastError();  // a machine without CUDA must not look like a failed call to the next check
    result.reason = std::string("CUDA finds no device: ") + cudaGetErrorString(status);
    return result;
  }
  for (int index = 0; index < count; ++index) {
    cudaDeviceProp properties;
    const cudaError_t described = cudaGetDeviceProperties(&properties, index);
    if (described != cudaSuccess) {
      (void)cudaGetLastError();
      result.reason = "CUDA cannot describe device " + std::to_string(index) + ": " + cudaGetErrorString(described);
      continue;
    }
    CudaDevice device{index, properties.name, properties.totalGlobalMem, properties.major, properties.minor};
    const std::string reason = objection(device);
    if (reason.empty()) {
      result.usable.push_back(std::move(device));
    } else {
      result.reason = reason;
    }
  }
  if (!result.usable.empty()) {
    result.reason.clear();
  } else if (result.reason.empty()) {
    result.reason = "CUDA finds no device: the driver lists none";
  }
  return result;
}

}  // namespace saddleback
