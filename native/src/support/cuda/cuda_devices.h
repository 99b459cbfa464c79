#pragma once
// The CUDA devices of this machine. Belongs to the separate CUDA part of the library, which may be missing.

#include <cstdint>
#include <string>
#include <vector>

namespace saddleback {

/// One CUDA device as its driver describes it.
struct CudaDevice {
  int index = 0;             ///< the driver's number
  std::string name;          ///< for a person to read
  std::uint64_t memory = 0;  ///< bytes
  int compute_major = 0;     ///< compute capability
  int compute_minor = 0;
};

struct CudaDevices {
  std::vector<CudaDevice> usable;  ///< in the driver's order
  std::string reason;              ///< one sentence: why none is usable; empty when one is
};

/// Asks the driver, if there is one. A machine without a driver or without a device is an answer and not an error:
/// never throws on account of the machine. Creates no context and touches no device memory.
CudaDevices cuda_devices();

}  // namespace saddleback
