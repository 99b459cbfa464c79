#pragma once
// The interface between a graph's queries and the CUDA module: plain data and calls back, since the two belong to
// modules that are not linked with one another.

#include <cstdint>

#include "geodesics/graph/arc_packing.h"
#include "support/cuda/cuda_module.h"

namespace saddleback {

/// A graph's arcs, to be kept on a device. Arrays are the caller's and live through the call.
struct CudaGraphRequest {
  int device = 0;                ///< the driver's number
  std::uint64_t most_bytes = 0;  ///< of device memory; 0: what is free
  std::int32_t node_count = 0;
  std::int64_t arc_count = 0;
  const std::int64_t* offsets = nullptr;  ///< (node_count + 1,)
  const std::uint64_t* words = nullptr;   ///< (arc_count,)
  const std::int32_t* nodes = nullptr;    ///< (node_count,) of the vertices
  ArcPacking packing;
};

/// Fields to be found in it: each from seeds of its own, as GraphSearch finds them.
struct SearchRequest {
  std::uint64_t most_bytes = 0;
  std::int32_t field_count = 0;
  const std::int64_t* first_seed = nullptr;    ///< (field_count + 1,)
  const std::int32_t* seed_nodes = nullptr;    ///< of a field's seeds
  const std::int32_t* seed_sources = nullptr;  ///< null unless sources are asked for
  const double* seed_distances = nullptr;      ///< below `bound`
  double bound = 0;                            ///< the first number beyond the limit
  double step = 0;                             ///< by which the front advances; the result does not depend on it
  double* distances = nullptr;                 ///< (field_count, node_count)
  std::int32_t* sources = nullptr;             ///< the same, or null
  bool by_node = false;                        ///< they are in the order of the nodes, else in that of the vertices
};

/// Holds what the CUDA module asks of its caller. It does not throw.
struct SearchCaller {
  void* self = nullptr;
  /// Tells the share done; false: stop.
  bool (*keep_going)(void* self, double fraction) = nullptr;
};

}  // namespace saddleback
