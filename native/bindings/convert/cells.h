#pragma once

#include "saddleback/tessellation/geodesic_voronoi.h"

#include "convert/convert.h"

namespace saddleback::bindings {

/// The Python object of a diagram on the mesh of a graph (a Python object), which stays as long as it. `by_cuda`: a
/// CUDA device found the vertices' nearest sites.
py::object make_cells(GeodesicVoronoi&& diagram, const py::object& graph, bool by_cuda);

/// A diagram and the graph whose mesh it lies on; both stay as long as the Python object.
struct CellsIn {
  const GeodesicVoronoi& diagram;
  const SaddleVertexGraph& graph;
};
/// The cells of an argument. \throw InputError when it is anything else.
CellsIn as_cells(const py::object& value, const char* argument);

}  // namespace saddleback::bindings
