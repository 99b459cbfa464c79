#pragma once
// Shortest paths in a graph on a CUDA device.

#include "geodesics/search_twin.h"

namespace saddleback {

/// Copies a graph's arcs to the device. They stay until they are dropped. Never throws; `reason` says why it failed.
TwinStatus put_graph_on_device(const GraphTwinRequest& request, GraphTwin** graph, double* seconds, TwinReason& reason);
void drop_graph_on_device(GraphTwin* graph);

/// Finds fields: the same bits as the processor's. Any number of threads may search a graph at once. Never throws.
TwinStatus search_on_device(const GraphTwin& graph, const SearchTwinRequest& request, const SearchTwinCaller& caller,
                            DeviceTimes& times, TwinReason& reason);

}  // namespace saddleback
