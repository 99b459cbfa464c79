#pragma once
// Points on a mesh as the callers of every binding give them: vertex indices or SurfacePoints.

#include <vector>

#include "saddleback/geodesics/saddle_vertex_graph.h"
#include "saddleback/mesh/surface_points.h"

#include "convert/convert.h"

// SurfacePoints crosses the border as a class of its own, never as a Python list.
PYBIND11_MAKE_OPAQUE(saddleback::SurfacePoints)

namespace saddleback::bindings {

/// Points of an argument. `vertices` is empty unless the caller gave vertex indices.
struct PointsIn {
  SurfacePoints points;
  bool are_vertices = false;
  std::vector<Index> vertices;
};

/// An integer array (or one integer) means vertices, a SurfacePoints anything on the surface; checked against the mesh.
/// \throw InputError naming `argument`, the position and the value.
PointsIn as_points(const py::object& value, const Mesh& mesh, const char* argument);

/// Works as as_points, when it does not matter how they were given.
SurfacePoints as_surface_points(const py::object& value, const Mesh& mesh, const char* argument);

/// Converts exactly one point.
SurfacePoint as_surface_point(const py::object& value, const Mesh& mesh, const char* argument);

/// The mesh of an argument. \throw InputError when it is anything else.
const Mesh& as_mesh(const py::object& value, const char* argument);

/// The graph of an argument `graph`. \throw InputError when it is anything else.
const SaddleVertexGraph& as_graph(const py::object& value);

}  // namespace saddleback::bindings
