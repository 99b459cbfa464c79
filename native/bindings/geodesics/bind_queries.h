#pragma once
// The graph's questions and neighbors are bound apart from the graph itself.

#include <pybind11/pybind11.h>

#include "saddleback/geodesics/saddle_vertex_graph.h"

namespace saddleback::bindings {

void bind_queries(pybind11::class_<SaddleVertexGraph>& graph);
void bind_neighbors(pybind11::class_<SaddleVertexGraph>& graph);

}  // namespace saddleback::bindings
