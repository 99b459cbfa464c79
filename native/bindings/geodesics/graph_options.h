#pragma once

#include "saddleback/geodesics/saddle_vertex_graph.h"

#include "convert/convert.h"

namespace saddleback::bindings {

/// Options with what k and accuracy say, None where not given. \throw InputError.
SaddleVertexGraphOptions graph_options(const py::object& k, const py::object& accuracy);

}  // namespace saddleback::bindings
