#pragma once
// What the separate CUDA module offers to the library, which neither links nor needs it: a table of functions, handed
// over at run time.

#include <cstdint>
#include <cstdio>

namespace saddleback {

struct ArcTwinRequest;
struct ArcTwinCaller;
struct ArcTwinTimes;

enum class TwinStatus { done, stopped, failed };

/// Why a twin failed: text that needs no common memory manager.
struct TwinReason {
  char text[512] = "";
  TwinReason& operator=(const char* reason) {
    std::snprintf(text, sizeof text, "%s", reason);
    return *this;
  }
};

/// Functions that never throw and keep nothing of what they are given.
struct CudaTwins {
  static constexpr int k_version = 1;  ///< of this table and of all that it passes
  int version = k_version;
  /// See geodesics/arc_twin.h.
  TwinStatus (*find_arcs)(const ArcTwinRequest&, const ArcTwinCaller&, ArcTwinTimes&, TwinReason&) = nullptr;
};

/// Tells the library of its twins, which stay valid until the process ends. \throw DeviceError for another version.
void set_cuda_twins(const CudaTwins* twins);
/// Null until they are told.
const CudaTwins* cuda_twins();

/// Bytes that the library may take of a device's memory, for all that is called from now on; 0: what is free.
void limit_cuda_memory(std::uint64_t bytes);
std::uint64_t cuda_memory_limit();

}  // namespace saddleback
