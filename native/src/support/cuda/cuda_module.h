#pragma once
// The functions of the separate CUDA module, which the library neither links nor needs: a table handed over at run
// time.

#include <cstdint>
#include <cstdio>

#include "saddleback/support/device_times.h"

namespace saddleback {

struct ArcsRequest;
struct ArcsCaller;
struct DiagramRequest;
struct DiagramCaller;
struct KeptPlane;  ///< a diagram's arrays on a device
struct CudaGraph;  ///< a graph's arcs on a device
struct CudaGraphRequest;
struct SearchRequest;
struct SearchCaller;

enum class CudaStatus {
  done,
  stopped,
  failed,
  left,  ///< to the processor, for which it is made
};

/// The reason for which a call of the CUDA module failed: text that needs no common memory manager.
struct CudaReason {
  char text[512] = "";
  CudaReason& operator=(const char* reason) {
    std::snprintf(text, sizeof text, "%s", reason);
    return *this;
  }
};

/// Functions that never throw and keep nothing of what they are given, but for graphs until they are dropped.
struct CudaModule {
  static constexpr int k_version = 10;  ///< of this table and of all that it passes
  int version = k_version;
  /// See geodesics/graph/arcs_abi.h.
  CudaStatus (*find_arcs)(const ArcsRequest&, const ArcsCaller&, DeviceTimes&, CudaReason&) = nullptr;
  /// See voronoi2d/cuda/diagram_abi.h.
  CudaStatus (*find_voronoi)(const DiagramRequest&, const DiagramCaller&, DeviceTimes&, CudaReason&) = nullptr;
  void (*drop_voronoi)(KeptPlane*) = nullptr;
  /// Copies bytes from a device's memory to the host's.
  CudaStatus (*copy_back)(int device, const void* from, void* to, std::uint64_t bytes, CudaReason&) = nullptr;
  /// Lets all devices copy to and from host memory by themselves, if they can.
  bool (*pin)(void* memory, std::uint64_t bytes) = nullptr;
  void (*unpin)(void* memory) = nullptr;
  /// See geodesics/queries/search_abi.h.
  CudaStatus (*put_graph)(const CudaGraphRequest&, CudaGraph**, double* seconds, CudaReason&) = nullptr;
  void (*drop_graph)(CudaGraph*) = nullptr;
  CudaStatus (*search)(const CudaGraph&, const SearchRequest&, const SearchCaller&, DeviceTimes&,
                       CudaReason&) = nullptr;
};

/// Tells the library of the CUDA module's functions, which stay valid until the process ends. \throw DeviceError for
/// another version.
void set_cuda_module(const CudaModule* module);
/// Returns the functions set; null until then.
const CudaModule* cuda_module();

/// Bytes that the library may take of a device's memory, for all that is called from now on; 0: what is free.
void limit_cuda_memory(std::uint64_t bytes);
std::uint64_t cuda_memory_limit();

}  // namespace saddleback
