#pragma once
// Shortest paths in a graph on a CUDA device.

#include "geodesics/queries/search_abi.h"

namespace saddleback {

/// Copies a graph's arcs to the device. They stay until they are dropped. Never throws; `reason` says why it failed.
CudaStatus put_graph_on_device(const CudaGraphRequest& request, CudaGraph** graph, double* seconds, CudaReason& reason);
void drop_graph_on_device(CudaGraph* graph);

/// Finds fields: the same bits as the processor's. Any number of threads may search a graph at once. Never throws.
CudaStatus search_on_device(const CudaGraph& graph, const SearchRequest& request, const SearchCaller& caller,
                            DeviceTimes& times, CudaReason& reason);

}  // namespace saddleback
