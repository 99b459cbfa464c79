#pragma once
// A dual mesh as Python holds it.

#include <optional>
#include <vector>

#include "saddleback/tessellation/dual_mesh.h"

#include "convert/convert.h"

namespace saddleback::bindings {

/// Holds a dual mesh with what its edges' lengths are found from, once asked for.
struct Dual : DualMesh {
  py::object owner;  ///< of the mesh and the cells
  py::object graph;
  const Mesh* mesh;
  const GeodesicVoronoi* cells;
  std::optional<std::vector<double>> edge_lengths;
};

}  // namespace saddleback::bindings
